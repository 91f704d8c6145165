// Designs turned by right angles.
#include "services/composer/model/quarter_turn.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::AssemblyPart;

constexpr Axis kX = Axis::kX, kY = Axis::kY, kZ = Axis::kZ;

// All 24 ways to lie.
std::vector<Eigen::Matrix3d> AllTurns() {
  std::vector<Eigen::Matrix3d> turns;
  for (const std::vector<Axis>& upright :
       {std::vector<Axis>{}, {kX}, {kX, kX}, {kX, kX, kX}, {kY}, {kY, kY, kY}}) {
    std::vector<Axis> axes = upright;
    for (int about_z = 0; about_z < 4; ++about_z, axes.push_back(kZ)) {
      turns.push_back(TurnOf(axes));
    }
  }
  return turns;
}

TEST(QuarterTurnsTest, LeadToAllTwentyFourWaysToLie) {
  std::set<std::vector<double>> distinct;
  for (const Eigen::Matrix3d& turn : AllTurns()) {
    EXPECT_EQ(turn.transpose() * turn, Eigen::Matrix3d::Identity());
    EXPECT_EQ(turn.determinant(), 1);
    distinct.insert({turn.data(), turn.data() + 9});
    const std::vector<Axis> fewest = QuarterTurnsOf(turn);
    EXPECT_LE(fewest.size(), 5U);
    EXPECT_EQ(TurnOf(fewest), turn);
  }
  EXPECT_EQ(distinct.size(), 24U);
}

TEST(QuarterTurnsTest, GoAgainstTheClock) {
  EXPECT_EQ(TurnOf({kZ}) * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  EXPECT_EQ(TurnOf({kX}) * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(TurnOf({kY}) * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());
  // The first comes first.
  EXPECT_EQ(TurnOf({kX, kZ}) * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(TurnOf({kZ, kX}) * Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitX());
}

class QuarterTurnTest : public ::testing::TestWithParam<std::string> {};

TEST_P(QuarterTurnTest, TurnedBackIsWhatItWas) {
  const Assembly& drawn = ShippedDesign(GetParam()).assembly->assembly();
  for (const std::vector<Axis>& turns :
       {std::vector<Axis>{kZ}, {kX}, {kY}, {kX, kY}, {kZ, kZ, kY}}) {
    const Eigen::Matrix3d turn = TurnOf(turns);
    const Assembly round = Turned(Turned(drawn, turn), turn.transpose());
    ASSERT_EQ(round.parts.size(), drawn.parts.size());
    for (std::size_t i = 0; i < drawn.parts.size(); ++i) {
      const AssemblyPart& a = drawn.parts[i];
      const AssemblyPart& b = round.parts[i];
      EXPECT_EQ(a.box.minimum, b.box.minimum);
      EXPECT_EQ(a.box.maximum, b.box.maximum);
      EXPECT_EQ(a.item_axes, b.item_axes);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(a.limits[k].minimum, b.limits[k].minimum);
        EXPECT_EQ(a.limits[k].maximum, b.limits[k].maximum);
      }
      for (std::size_t k = 0; k < a.prominent_planes.size(); ++k) {
        EXPECT_EQ(a.prominent_planes[k].axis, b.prominent_planes[k].axis);
        EXPECT_EQ(a.prominent_planes[k].position, b.prominent_planes[k].position);
      }
      ASSERT_EQ(a.shape == nullptr, b.shape == nullptr);
      if (a.shape != nullptr) {
        EXPECT_EQ(a.shape->fractions, b.shape->fractions);
        EXPECT_EQ(a.shape->turn, b.shape->turn);
      }
    }
    for (std::size_t j = 0; j < drawn.joints.size(); ++j) {
      EXPECT_EQ(drawn.joints[j].center, round.joints[j].center);
      EXPECT_EQ(drawn.joints[j].axis, round.joints[j].axis);
      for (std::size_t k = 0; k < drawn.joints[j].rest_poses.size(); ++k) {
        EXPECT_EQ(drawn.joints[j].rest_poses[k].motion, round.joints[j].rest_poses[k].motion);
      }
    }
  }
}

// A turned design is the same design: as many elements, relationships and freedoms, and as sound;
// whatever has become of it since it was drawn is there when it is turned.
TEST_P(QuarterTurnTest, ATurnedDesignIsParametrisedAsItWas) {
  Design design = ShippedDesign(GetParam());
  const Eigen::Matrix3d turn = TurnOf({kZ});
  const Assembly turned = Turned(design.assembly->assembly(), turn);
  EXPECT_THAT(parametric::ValidateAssembly(turned), ::testing::IsEmpty());
  ASSERT_OK_AND_ASSIGN(const Design made, AsDrawn(turned));
  EXPECT_EQ(made.assembly->elements().size(), design.assembly->elements().size());
  EXPECT_EQ(made.assembly->contacts().size(), design.assembly->contacts().size());
  EXPECT_EQ(made.assembly->feasible_set().degrees_of_freedom(),
            design.assembly->feasible_set().degrees_of_freedom());
  ASSERT_OK_AND_ASSIGN(const auto samples, made.assembly->Sample(3, 1));
  for (const Eigen::VectorXd& q : samples) {
    ASSERT_OK_AND_ASSIGN(const auto faults, made.assembly->FaultsAt(q));
    for (const auto& fault : faults) ADD_FAILURE() << parametric::Describe(fault);
  }
  ASSERT_OK_AND_ASSIGN(const auto changed, design.assembly->Sample(1, 2));
  design.q = changed.front();
  design.shift = {1, -2, 0.5};
  ASSERT_OK_AND_ASSIGN(const Design there, Turned(design, made.assembly, turn));
  EXPECT_TRUE(there.assembly->feasible_set().Violations(there.q, 1e-8).empty());
  const std::vector<parametric::PlacedPart> before = PartsOf(design), after = PartsOf(there);
  std::map<std::string, Eigen::Vector3d> sizes;
  for (const auto& part : before) sizes[part.name] = part.box.size();
  ASSERT_EQ(after.size(), before.size());
  for (const auto& part : after) {
    ASSERT_TRUE(sizes.contains(part.name)) << part.name;
    EXPECT_LE((part.box.size() - turn.cwiseAbs() * sizes[part.name]).norm(), 1e-6) << part.name;
  }
  // Its foot stays.
  const parametric::BoundingBox a = BoundsOf(design), b = BoundsOf(there);
  EXPECT_LE((a.center() - b.center()).norm(), 1e-9);
  EXPECT_NEAR(a.minimum.z(), b.minimum.z(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Collection, QuarterTurnTest,
                         ::testing::Values("bookshelf", "cabinet", "tool_cart", "toy_chest",
                                           "dining_table"),
                         [](const auto& shipped) { return shipped.param; });

TEST(QuarterTurnTest, WhatWasInFrontIsThenOnTheRight) {
  const Assembly& drawn = ShippedDesign("toy_chest").assembly->assembly();
  const Assembly turned = Turned(drawn, TurnOf({kZ}));
  for (std::size_t i = 0; i < drawn.parts.size(); ++i) {
    if (drawn.parts[i].name != "front") continue;
    EXPECT_NEAR(turned.parts[i].box.maximum.x(), -drawn.parts[i].box.minimum.y(), 1e-12);
    EXPECT_NEAR(turned.parts[i].box.size().y(), drawn.parts[i].box.size().x(), 1e-12);
  }
  EXPECT_EQ(turned.joints[0].axis, Eigen::Vector3d(0, drawn.joints[0].axis.x(), 0));
}

}  // namespace
}  // namespace mortise::composer
