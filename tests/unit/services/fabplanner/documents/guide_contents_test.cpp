// What guides say, of small designs and of large ones.
#include "services/fabplanner/documents/guide_contents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/fabplanner/planning/planning.h"
#include "tests/support/png_image.h"
#include "tests/unit/services/fabplanner/example_wall.h"

namespace mortise::fabplanner {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const GuideTable& TableOf(const GuideStep& step, const std::string& column) {
  for (const GuideTable& table : step.tables) {
    if (table.columns.front() == column) return table;
  }
  ADD_FAILURE() << "step " << step.number << " has no table of " << column;
  static const GuideTable kNone;
  return kNone;
}

TEST(GuideContentsTest, CountsFastenersOfAStep) {
  const FabricationPlan plan = MakePlan(ExampleTable(), ExampleItems(), 2).value();
  const auto contents = ContentsOf(plan, ExampleTable(), ExampleItems(), "Table");
  ASSERT_TRUE(contents.ok()) << contents.status();
  EXPECT_EQ(contents->summary, "9 parts, 22 pegs, 3 steps; make 2 of them");
  ASSERT_THAT(contents->steps, SizeIs(3));
  const GuideTable& fasteners = contents->steps[0].tables.front();
  EXPECT_EQ(fasteners.heading, "Fasteners");
  ASSERT_THAT(fasteners.rows, SizeIs(1));
  EXPECT_EQ(fasteners.rows[0].count, 8);
  EXPECT_THAT(fasteners.rows[0].cells, ElementsAre("Beech dowel"));
  EXPECT_THAT(contents->fasteners, SizeIs(1));
  const auto picture = testing::DecodePng(contents->fasteners[0].picture);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->width, 240);
}

TEST(GuideContentsTest, TellsScrewsOfAStepOnce) {
  const FabricationPlan plan = MakePlan(ExampleRack(), ExampleItems(), 1).value();
  const auto contents = ContentsOf(plan, ExampleRack(), ExampleItems(), "Rack");
  ASSERT_TRUE(contents.ok()) << contents.status();
  EXPECT_TRUE(contents->has_ways);
  int screws = 0;
  for (const GuideStep& step : contents->steps) {
    for (const GuideTable& table : step.tables) {
      if (table.heading != "Fasteners") continue;
      ASSERT_THAT(table.rows, SizeIs(1));
      EXPECT_THAT(table.rows[0].cells, ElementsAre("Wood screw 4 × 40"));
      screws += table.rows[0].count;
    }
  }
  EXPECT_EQ(screws, 4);
}

TEST(GuideContentsTest, AWallOfManyPegsStaysReadable) {
  const Design wall = ExampleWall();
  ASSERT_EQ(wall.pegs.size(), 1333u);
  const FabricationPlan plan = MakePlan(wall, WallItems(), 1).value();
  const auto contents = ContentsOf(plan, wall, WallItems(), "Wall");
  ASSERT_TRUE(contents.ok()) << contents.status();
  EXPECT_THAT(contents->summary, HasSubstr("1333 pegs"));
  int pegs = 0;
  for (const GuideStep& step : contents->steps) {
    for (const GuideTable& table : step.tables) EXPECT_LE(table.rows.size(), 2u);
    for (const GuideRow& row : TableOf(step, "Item").rows) pegs += row.count;
  }
  EXPECT_EQ(pegs, 1333);
  EXPECT_EQ(TableOf(contents->steps[0], "Pegs").rows.front().count, 16 * 43);
}

TEST(GuideContentsTest, AnEmptyPlanSaysNothing) {
  const auto contents = ContentsOf({}, {}, {}, "Nothing");
  ASSERT_TRUE(contents.ok()) << contents.status();
  EXPECT_THAT(contents->tables, SizeIs(0));
  EXPECT_THAT(contents->steps, SizeIs(0));
}

}  // namespace
}  // namespace mortise::fabplanner
