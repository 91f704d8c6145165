// Toppling margins in every pose, against what geometry gives.
#include "services/composer/holding/standing_in_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/holding/holding_parts.h"

namespace mortise::composer {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(StandingInPosesTest, OfACube) {
  ASSERT_OK_AND_ASSIGN(Design cube,
                       AsDrawn(parametric::Named(
                           "cube", {parametric::FixedPart("cube", {1, 1, 0.5}, {1.4, 1.4, 0.9})})));
  // Wherever it is moved to, it stands on its lower side.
  for (const Eigen::Vector3d& shift : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(3, -2, 1)}) {
    cube.shift = shift;
    const ModelStanding found = StandingInPoses(cube, TestItems(), TestMaterials());
    EXPECT_NEAR(found.mass, 0.064 * kWood, 1e-9);
    EXPECT_THAT(found.without_mass, IsEmpty());
    ASSERT_EQ(found.poses.size(), 1U);
    EXPECT_NEAR(found.poses[0].standing.margin, 0.2, 1e-9);
    EXPECT_NEAR(found.poses[0].standing.angle, std::numbers::pi / 4, 1e-9);
    EXPECT_LT((found.poses[0].center_of_mass - Eigen::Vector3d(1.2, 1.2, 0.7) - shift).norm(),
              1e-9);
  }
}

// The lid, upright at the back, moves the centre of mass backwards by half its depth in proportion
// to its mass.
TEST(StandingInPosesTest, OfAChestWithItsLidOpen) {
  ASSERT_OK_AND_ASSIGN(const Design chest, AsDrawn(parametric::ChestWithLid()));
  const ModelStanding found = StandingInPoses(chest, TestItems(), TestMaterials());
  ASSERT_EQ(found.poses.size(), 2U);
  EXPECT_EQ(found.poses[1].pose, "lid hinge: open");
  const double lid = 1.0 * 0.5 * 0.02;
  const double rest = 2 * 0.02 * 0.5 * 0.6 + 4 * 0.96 * 0.5 * 0.02;
  const double behind = 0.25 * lid / (lid + rest);
  EXPECT_NEAR(found.poses[0].standing.margin, 0.25, 1e-9);
  EXPECT_NEAR(found.poses[1].standing.margin, 0.25 - behind, 1e-9);
  EXPECT_NEAR(found.poses[1].center_of_mass.y(), 0.25 + behind, 1e-9);
  EXPECT_EQ(WorstPose(found), 1U);
  EXPECT_EQ(DirectionName(found.poses[1].standing.falls_towards), "to the back (+y)");
}

TEST(StandingInPosesTest, WhatHasNoMaterialWeighsNothing) {
  ASSERT_OK_AND_ASSIGN(const Design table, AsDrawn(parametric::TwoLeggedTable()));
  std::vector<parametric::Item> items = TestItems();
  std::erase_if(items, [](const parametric::Item& item) { return item.name == "items/panel"; });
  const ModelStanding found = StandingInPoses(table, items, TestMaterials());
  EXPECT_THAT(found.without_mass, ElementsAre("top"));
  EXPECT_NEAR(found.mass, 2 * 0.06 * 0.4 * 0.7 * kWood, 1e-9);
}

TEST(StandingInPosesTest, NamesTheWayItFalls) {
  EXPECT_EQ(DirectionName({0, -1}), "to the front (-y)");
  EXPECT_EQ(DirectionName({1, 0}), "to the right (+x)");
  EXPECT_EQ(DirectionName(Eigen::Vector2d(-1, 1).normalized()), "to the back left (+y, -x)");
  EXPECT_EQ(DirectionName({0, 0}), "to any side");
}

}  // namespace
}  // namespace mortise::composer
