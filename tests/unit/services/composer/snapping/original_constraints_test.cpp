// What the original design says of where its components go.
#include "services/composer/snapping/original_constraints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

// The constraints by the component's planes, of a sub-tree as drawn.
std::map<std::string, OriginalConstraint> ConstraintsOf(const std::string& id,
                                                        const std::string& node) {
  const Design component = ShippedComponent(id, node);
  const std::vector<PrincipalPart> parts = PrincipalPartsOf(component);
  const std::vector<DesignPlane> planes = PlanesOf(component, parts);
  std::map<std::string, OriginalConstraint> by_plane;
  for (const OriginalConstraint& one :
       FindOriginalConstraints(ShippedDesign(id), parts, planes, 0.1)) {
    by_plane[Describe(planes[static_cast<std::size_t>(one.plane)])] = one;
  }
  return by_plane;
}

// The third of six boards touches the sides and the back, and is level with the sides in front;
// nothing is said of its height.
TEST(OriginalConstraintsTest, AShelfLiesBetweenItsSides) {
  const auto constraints = ConstraintsOf("bookshelf", "shelf 3");
  ASSERT_EQ(constraints.size(), 4U);
  const OriginalConstraint& left = constraints.at("'shelf 3' x minimum");
  EXPECT_TRUE(left.is_contact);
  ASSERT_EQ(left.outside.size(), 1U);
  EXPECT_EQ(left.outside[0].side, PlaneSide::kMaximum);
  EXPECT_TRUE(left.outside[0].is_broad);
  EXPECT_NEAR(left.area, 0.018 * 0.3, 1e-12);
  EXPECT_EQ(constraints.at("'shelf 3' x maximum").outside[0].side, PlaneSide::kMinimum);
  EXPECT_TRUE(constraints.at("'shelf 3' y maximum").is_contact);
  EXPECT_FALSE(constraints.at("'shelf 3' y minimum").is_contact);
  EXPECT_EQ(constraints.at("'shelf 3' y minimum").outside[0].side, PlaneSide::kMinimum);
}

// Its slides are 12.7 mm thick.
TEST(OriginalConstraintsTest, WhatFastenersHoldApartStaysApart) {
  const auto constraints = ConstraintsOf("tool_cart", "drawer");
  const OriginalConstraint& left = constraints.at("'drawer side 1' x minimum");
  EXPECT_TRUE(left.is_contact);
  ASSERT_EQ(left.outside.size(), 1U);
  EXPECT_EQ(left.outside[0].side, PlaneSide::kMaximum);
  EXPECT_NEAR(left.outside[0].offset, 0.0127, 1e-9);
  EXPECT_NEAR(constraints.at("'drawer side 2' x maximum").outside[0].offset, -0.0127, 1e-9);
}

TEST(OriginalConstraintsTest, ProminentPlanesAreThereToBeAlignedWith) {
  const auto constraints = ConstraintsOf("cabinet", "left door");
  const OriginalConstraint& right = constraints.at("'left door' x maximum");
  EXPECT_FALSE(right.is_contact);
  ASSERT_EQ(right.outside.size(), 1U);
  EXPECT_EQ(right.outside[0].prominent, "left fronts");
}

// The jaw of the vise lies against the edge of the top when it is closed.
TEST(OriginalConstraintsTest, WhatAJointMovesAwayIsLeftOut) {
  const auto constraints = ConstraintsOf("workbench", "top board");
  const OriginalConstraint& front = constraints.at("'top board' y minimum");
  EXPECT_FALSE(front.is_contact);
  for (const OutsidePlane& outside : front.outside) EXPECT_EQ(outside.side, PlaneSide::kMinimum);
}

TEST(OriginalConstraintsTest, ContactsComeFirst) {
  const Design component = ShippedComponent("bookshelf", "shelf 3");
  const std::vector<PrincipalPart> parts = PrincipalPartsOf(component);
  const auto found =
      FindOriginalConstraints(ShippedDesign("bookshelf"), parts, PlanesOf(component, parts), 0.1);
  ASSERT_EQ(found.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(found[i].is_contact, i < 3);
  EXPECT_GE(found[0].area, found[1].area);
}

}  // namespace
}  // namespace mortise::composer
