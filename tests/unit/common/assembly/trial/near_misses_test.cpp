// Gaps of hundredths of a millimetre are named, not only that something has no hold.
#include "common/assembly/trial/near_misses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/assembly/parametric_assembly.h"
#include "common/assembly/trial/drawn_contacts.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// Two posts, and a shelf that misses the second by `gap`, m.
Assembly ShelfBetweenPosts(double gap) {
  Assembly shelf;
  shelf.name = "shelf";
  shelf.groups = {{"shelf", -1}};
  shelf.parts = {ResizablePart("left", {0, 0, 0}, {0.02, 0.3, 1.0}),
                 ResizablePart("board", {0.02, 0, 0.5}, {0.62, 0.3, 0.52}),
                 ResizablePart("right", {0.62 + gap, 0.31, 0.1}, {0.64 + gap, 0.41, 0.45}),
                 ResizablePart("peg", {0.3, 0.1, 0.52 + gap}, {0.31, 0.11, 0.6})};
  return shelf;
}

TEST(NearMisses, AreNamedWithGapNeighbourAndTolerance) {
  const absl::Status refused = ParametricAssembly::Create(ShelfBetweenPosts(1e-5)).status();
  EXPECT_EQ(DetailOf(refused).reason, "FEASIBLE_SET_UNBOUNDED");
  EXPECT_THAT(std::string(refused.message()),
              AllOf(HasSubstr("without end"), HasSubstr("'peg' misses 'board' by 0.01 mm"),
                    HasSubstr("'tolerance' 1.1e-05 m")));
}

TEST(NearMisses, AreNotNamedWhereNothingIsNear) {
  const absl::Status refused = ParametricAssembly::Create(ShelfBetweenPosts(0.05)).status();
  EXPECT_EQ(DetailOf(refused).reason, "FEASIBLE_SET_UNBOUNDED");
  EXPECT_THAT(std::string(refused.message()), Not(HasSubstr("misses")));
}

TEST(NearMisses, ComeNearestFirst) {
  Assembly three = ShelfBetweenPosts(1e-4);
  three.parts.push_back(ResizablePart("cup", {0.4, 0.1, 0.52 + 5e-5}, {0.45, 0.15, 0.6}));
  ASSERT_OK_AND_ASSIGN(const auto misses, FindNearMisses(three, 1e-6, 1e-3));
  ASSERT_EQ(misses.size(), 2U);
  EXPECT_EQ(misses[0].second, 4);
  EXPECT_NEAR(misses[0].gap, 5e-5, 1e-9);
  EXPECT_EQ(misses[1].second, 3);
  EXPECT_NEAR(misses[1].gap, 1e-4, 1e-9);
}

}  // namespace
}  // namespace mortise::parametric
