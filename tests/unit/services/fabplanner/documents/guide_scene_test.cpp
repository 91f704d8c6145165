// Shapes of a guide as its page carries them.
#include "services/fabplanner/documents/guide_scene.h"

#include <gtest/gtest.h>

#include "services/fabplanner/planning/planning.h"
#include "tests/unit/services/fabplanner/example_wall.h"

namespace mortise::fabplanner {
namespace {

std::vector<SceneStep> StepsOf(const Design& design, const Items& items,
                               const FabricationPlan& plan) {
  std::vector<SceneStep> steps;
  for (const AssemblyStep& step : plan.steps) {
    steps.push_back(
        {step.number, ArrangeStep(design, items, plan.holes, plan.steps, step.number), {1, -1, 1}});
  }
  return steps;
}

int Fasteners(const StepArrangement& arrangement) {
  int count = static_cast<int>(arrangement.pegs.size());
  for (const ArrangedPart& part : arrangement.parts) count += part.role == StepRole::kFastener;
  return count;
}

TEST(GuideSceneTest, KeepsAlikeShapesOnce) {
  const Design table = ExampleTable();
  const FabricationPlan plan = MakePlan(table, ExampleItems(), 1).value();
  const auto scene = PackGuideScene(StepsOf(table, ExampleItems(), plan));
  ASSERT_TRUE(scene.ok()) << scene.status();
  // A leg, two kinds of aprons, a top; pegs along x, y and z, to either side.
  EXPECT_LE(scene->description["shapes"].size(), 4u + 5u);
  ASSERT_EQ(scene->description["steps"].size(), 3u);
  EXPECT_EQ(scene->description["steps"][0]["goals"], 8);
  EXPECT_EQ(scene->description["steps"][2]["instances"], 9 + 6);
  // The longest side is that of the top, 1.3 m.
  EXPECT_NEAR(scene->rounding, std::sqrt(3) / 2 * 1.3 / 65535, 1e-9);
}

TEST(GuideSceneTest, ThousandsOfPegsTakeLittle) {
  const Design wall = ExampleWall();
  const FabricationPlan plan = MakePlan(wall, WallItems(), 1).value();
  const std::vector<SceneStep> steps = StepsOf(wall, WallItems(), plan);
  int pegs = 0;
  for (const SceneStep& step : steps) pegs += Fasteners(step.arrangement);
  EXPECT_EQ(pegs, 1333);
  const auto scene = PackGuideScene(steps);
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_LT(scene->pack.size() + scene->description.dump().size(), 200'000u);
  EXPECT_LE(scene->description["shapes"].size(), 10u);
}

TEST(GuideSceneTest, TheSamePlanGivesTheSameScene) {
  const auto pack = [] {
    const Design rack = ExampleRack();
    const FabricationPlan plan = MakePlan(rack, ExampleItems(), 1).value();
    const GuideScene scene = PackGuideScene(StepsOf(rack, ExampleItems(), plan)).value();
    return scene.description.dump() + scene.pack;
  };
  EXPECT_EQ(pack(), pack());
}

TEST(GuideSceneTest, NothingIsAScene) {
  const auto scene = PackGuideScene({});
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_EQ(scene->description["shapes"].size(), 0u);
}

TEST(StepArrangementTest, FastenersGoWhereTheirHolesAre) {
  const Design rack = ExampleRack();
  const FabricationPlan plan = MakePlan(rack, ExampleItems(), 1).value();
  int goals = 0;
  for (const AssemblyStep& step : plan.steps) {
    const StepArrangement arrangement =
        ArrangeStep(rack, ExampleItems(), plan.holes, plan.steps, step.number);
    EXPECT_EQ(static_cast<int>(arrangement.goals.size()), Fasteners(arrangement));
    for (const StepWay& goal : arrangement.goals) {
      ++goals;
      // Screws stand before the side that they go through, and come along their axis.
      const Eigen::Vector3d way = (goal.to - goal.from).normalized();
      EXPECT_NEAR(std::abs(way.x()), 1, 1e-9);
    }
  }
  EXPECT_EQ(goals, 4);
}

}  // namespace
}  // namespace mortise::fabplanner
