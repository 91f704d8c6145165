// Designs turned by right angles.
#include "services/composer/model/quarter_turn.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::AssemblyPart;

class QuarterTurnTest : public ::testing::TestWithParam<std::string> {};

TEST_P(QuarterTurnTest, FourAreNone) {
  const Assembly& drawn = ShippedDesign(GetParam()).assembly->assembly();
  const Assembly round = QuarterTurned(QuarterTurned(QuarterTurned(drawn, 1), 2), -3);
  ASSERT_EQ(round.parts.size(), drawn.parts.size());
  for (std::size_t i = 0; i < drawn.parts.size(); ++i) {
    const AssemblyPart& a = drawn.parts[i];
    const AssemblyPart& b = round.parts[i];
    EXPECT_EQ(a.box.minimum, b.box.minimum);
    EXPECT_EQ(a.box.maximum, b.box.maximum);
    EXPECT_EQ(a.item_axes, b.item_axes);
    for (std::size_t k = 0; k < a.prominent_planes.size(); ++k) {
      EXPECT_EQ(a.prominent_planes[k].axis, b.prominent_planes[k].axis);
      EXPECT_EQ(a.prominent_planes[k].position, b.prominent_planes[k].position);
    }
    ASSERT_EQ(a.shape == nullptr, b.shape == nullptr);
    if (a.shape != nullptr) {
      EXPECT_EQ(a.shape->fractions, b.shape->fractions);
    }
  }
  for (std::size_t j = 0; j < drawn.joints.size(); ++j) {
    EXPECT_EQ(drawn.joints[j].center, round.joints[j].center);
    EXPECT_EQ(drawn.joints[j].axis, round.joints[j].axis);
  }
}

// A turned design is the same design: as many elements, relationships and freedoms, and as sound.
TEST_P(QuarterTurnTest, ATurnedDesignIsParametrisedAsItWas) {
  const Design& design = ShippedDesign(GetParam());
  const Assembly turned = QuarterTurned(design.assembly->assembly(), 1);
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
}

INSTANTIATE_TEST_SUITE_P(Collection, QuarterTurnTest,
                         ::testing::Values("bookshelf", "cabinet", "tool_cart", "toy_chest",
                                           "dining_table"),
                         [](const auto& shipped) { return shipped.param; });

TEST(QuarterTurnTest, WhatWasInFrontIsThenOnTheRight) {
  const Assembly& drawn = ShippedDesign("toy_chest").assembly->assembly();
  const Assembly turned = QuarterTurned(drawn, 1);
  for (std::size_t i = 0; i < drawn.parts.size(); ++i) {
    if (drawn.parts[i].name != "front") continue;
    EXPECT_NEAR(turned.parts[i].box.maximum.x(), -drawn.parts[i].box.minimum.y(), 1e-12);
    EXPECT_NEAR(turned.parts[i].box.size().y(), drawn.parts[i].box.size().x(), 1e-12);
  }
  EXPECT_EQ(turned.joints[0].axis, Eigen::Vector3d(0, drawn.joints[0].axis.x(), 0));
}

}  // namespace
}  // namespace mortise::composer
