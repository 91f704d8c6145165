#include "services/fabplanner/joining/joinery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "common/base/errors.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

TEST(JoineryTest, EachPegHasAHoleInBothPartsOneMillimetreDeeper) {
  const Design design = ExampleTable();
  const auto holes = HolesFor(design);
  ASSERT_TRUE(holes.ok()) << holes.status();
  ASSERT_EQ(holes->size(), 2 * design.pegs.size());
  for (std::size_t i = 0; i < design.pegs.size(); ++i) {
    const Peg& peg = design.pegs[i];
    const Hole& own = (*holes)[2 * i];
    const Hole& other = (*holes)[2 * i + 1];
    EXPECT_EQ(own.part, peg.part);
    EXPECT_EQ(other.part, peg.other_part);
    EXPECT_NEAR((own.direction + other.direction).norm(), 0, 1e-12);
    EXPECT_EQ(other.direction, peg.direction);
    EXPECT_DOUBLE_EQ(own.depth, peg.depth_in_part + 0.001);
    EXPECT_NEAR(own.depth + other.depth, peg.length + 0.002, 1e-12);
    EXPECT_EQ(own.diameter, peg.diameter);
    EXPECT_EQ(own.connector, peg.connection);
    EXPECT_EQ(other.connector, peg.connection);
  }
}

TEST(JoineryTest, CountsPegsByItem) {
  EXPECT_THAT(CountPegs(ExampleTable()),
              testing::ElementsAre(testing::Pair("items/dowel-8x35", 22)));
}

TEST(JoineryTest, NamesThePartThatAPegWouldPierce) {
  Design design = ExampleTable();
  design.pegs.back().depth_in_part = 0.0175;  // in the 18 mm top: 18.5 mm with the clearance
  const auto holes = HolesFor(design);
  EXPECT_EQ(DetailOf(holes.status()).reason, "PEG_TOO_LONG");
  EXPECT_EQ(DetailOf(holes.status()).field, "top");
  EXPECT_THAT(holes.status().message(), testing::HasSubstr("18.5 mm in part top"));
  EXPECT_THAT(holes.status().message(), testing::HasSubstr("18 mm deep"));
}

TEST(JoineryTest, RefusesUnusablePegs) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& spoil : std::vector<std::function<void(Peg&)>>{
           [&](Peg& peg) { peg.position.x() = nan; }, [](Peg& peg) { peg.direction *= 2; },
           [](Peg& peg) { peg.diameter = 0; }, [](Peg& peg) { peg.depth_in_part = peg.length; },
           [](Peg& peg) { peg.part = "nowhere"; }}) {
    Design design = ExampleTable();
    spoil(design.pegs[3]);
    const auto holes = HolesFor(design);
    EXPECT_EQ(holes.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(DetailOf(holes.status()).field, testing::HasSubstr(design.pegs[3].connection));
  }
}

}  // namespace
}  // namespace mortise::fabplanner
