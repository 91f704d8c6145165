#include "services/composer/connecting/side_overlaps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/composer/model/overlap.h"
#include "tests/unit/common/assembly/bookcase.h"

namespace mortise::composer {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

Design OneBoard(const std::string& name) {
  parametric::Assembly assembly;
  assembly.name = name;
  assembly.groups = {{name, -1}};
  assembly.parts = {parametric::Board(name, {0, 0, 0}, {1, 0.3, 0.02}, 0)};
  return AsDrawn(std::move(assembly)).value();
}

// A shelf on a board, so deep in it, m; less than 0: above it.
BothSides ShelfInBoard(double depth) {
  Design shelf = OneBoard("shelf");
  shelf.shift = {0, 0, 0.02 - depth};
  return SidesOf(OneBoard("board"), shelf);
}

std::vector<SideOverlap> OverlapsIn(const BothSides& sides) {
  return OverlapsBetween(SolidsOf(sides.body), SolidsOf(sides.component));
}

TEST(SideOverlaps, AreAsDeepAsTheyReachIntoEachOther) {
  const std::vector<SideOverlap> overlaps = OverlapsIn(ShelfInBoard(0.004));
  ASSERT_THAT(overlaps, SizeIs(1));
  EXPECT_EQ(overlaps[0].body, "board");
  EXPECT_EQ(overlaps[0].component, "shelf");
  EXPECT_NEAR(overlaps[0].depth, 0.004, 1e-9);
  EXPECT_EQ(Describe({"board", "shelf", 0.004}), "'shelf' reaches 4 mm into 'board' of the model");
}

TEST(SideOverlaps, AreNoneOfWhatTouchesOrIsApart) {
  EXPECT_THAT(OverlapsIn(ShelfInBoard(0)), IsEmpty());
  EXPECT_THAT(OverlapsIn(ShelfInBoard(kMaxOverlap / 2)), IsEmpty());
  EXPECT_THAT(OverlapsIn(ShelfInBoard(-0.1)), IsEmpty());
}

TEST(SideOverlaps, AreNewWhereTheyWereNotOrGetDeeper) {
  const auto none = OverlapsIn(ShelfInBoard(0));
  const auto before = OverlapsIn(ShelfInBoard(0.004));
  const auto deeper = OverlapsIn(ShelfInBoard(0.005));
  EXPECT_THAT(NewOverlaps(none, before), SizeIs(1));
  EXPECT_THAT(NewOverlaps(before, deeper), SizeIs(1));
  EXPECT_THAT(NewOverlaps(before, before), IsEmpty());
  EXPECT_THAT(NewOverlaps(deeper, before), IsEmpty());
}

}  // namespace
}  // namespace mortise::composer
