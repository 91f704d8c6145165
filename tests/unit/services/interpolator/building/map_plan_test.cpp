// Designs of places and points, and points of designs.
#include "services/interpolator/building/map_plan.h"

#include <gtest/gtest.h>

#include "tests/unit/services/interpolator/building/example_plan.h"

namespace mortise::interpolator {
namespace {

TEST(MapPlanTest, KnowsWhichParametersAreWhole) {
  const MapPlan plan = ExamplePlan(100);
  EXPECT_EQ(plan.NumberParameters(), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(plan.WholeParameters(), (std::vector<std::size_t>{1}));
}

TEST(MapPlanTest, TurnsPlacesIntoDesigns) {
  const MapPlan plan = ExamplePlan(100);
  EXPECT_EQ(plan.DesignAt(1, Eigen::Vector2d(0.25, 0.5)), Eigen::Vector4d(0.25, 7, 3, 11));
  EXPECT_EQ(plan.DesignAt(0, Eigen::Vector2d(0, 1)), Eigen::Vector4d(0, 7, 1, 12));
}

TEST(MapPlanTest, MeetsTheEndsOfRangesExactly) {
  MapPlan plan = ExamplePlan(100);
  plan.parameters[0].minimum = 0.1;
  plan.parameters[0].maximum = 0.7;
  EXPECT_EQ(plan.DesignAt(0, Eigen::Vector2d(0, 0))[0], 0.1);
  EXPECT_EQ(plan.DesignAt(0, Eigen::Vector2d(1, 0))[0], 0.7);
}

TEST(MapPlanTest, TurnsPointsIntoDesignsAndBack) {
  const MapPlan plan = ExamplePlan(100);
  const Eigen::Vector3d point(0.5, 3, 10.5);
  EXPECT_EQ(plan.DesignOf(point), Eigen::Vector4d(0.5, 7, 3, 10.5));
  EXPECT_EQ(plan.PointOf(plan.DesignOf(point)), point);
}

}  // namespace
}  // namespace mortise::interpolator
