// What lets parts of designs that ship move, and what does not.
#include "services/composer/connecting/guides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "common/assembly/model/rest_pose.h"
#include "services/composer/connecting/motions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::ElementConnection;
using parametric::ItemKind;
using parametric::Joint;
using parametric::JointKind;

// A connection of two boards by one part of this kind, of which the second turns about the z axis,
// or slides along it.
class GuidesTest : public ::testing::Test {
 protected:
  GuidesTest() {
    connection_.principals = {0, 1};
    connection_.connecting = {2};
    connection_.elements.resize(3);
    connection_.assembly.parts.resize(3);
    connection_.elements[2].parts = {2};
    connection_.tolerance = 1e-6;
    Put({{-0.01, -0.01, 0}, {0.01, 0.01, 0.1}}, Axis::kZ);
    turns_.kind = JointKind::kHinge;
    slides_.kind = JointKind::kPrismatic;
    point_.kind = JointKind::kBall;
    point_.center = {0, 0, 0.05};
  }

  void Put(const BoundingBox& box, Axis length) {
    connection_.elements[2].box = box;
    connection_.assembly.parts[2].item_axes[0] = length;
  }

  bool Lets(ItemKind kind, const Joint& joint) const {
    return Guides(connection_, joint, [kind](const std::string&) { return std::optional(kind); });
  }

  ElementConnection connection_;
  Joint turns_, slides_, point_;
};

TEST_F(GuidesTest, HardwareLetsMoveWhatItIsMadeFor) {
  EXPECT_TRUE(Lets(ItemKind::kHinge, turns_));
  EXPECT_FALSE(Lets(ItemKind::kHinge, slides_));
  EXPECT_FALSE(Lets(ItemKind::kHinge, point_));
  EXPECT_TRUE(Lets(ItemKind::kDrawerSlide, slides_));
  EXPECT_FALSE(Lets(ItemKind::kDrawerSlide, turns_));
  for (const ItemKind kind : {ItemKind::kNut, ItemKind::kWasher, ItemKind::kBracket}) {
    for (const Joint& joint : {turns_, slides_, point_}) EXPECT_FALSE(Lets(kind, joint));
  }
}

TEST_F(GuidesTest, PinsLetTurnWhatIsOnThem) {
  for (const ItemKind kind : {ItemKind::kScrew, ItemKind::kBolt, ItemKind::kDowel, ItemKind::kTube,
                              ItemKind::kThreadedRod, ItemKind::kBearing}) {
    EXPECT_TRUE(Lets(kind, turns_)) << static_cast<int>(kind);
    EXPECT_TRUE(Lets(kind, point_)) << static_cast<int>(kind);
    EXPECT_EQ(Lets(kind, slides_), kind != ItemKind::kScrew) << static_cast<int>(kind);
  }
  // Beside the axis, as the screws of a catch.
  Put({{0.2, -0.01, 0}, {0.22, 0.01, 0.1}}, Axis::kX);
  for (const ItemKind kind : {ItemKind::kScrew, ItemKind::kBolt, ItemKind::kHinge,
                              ItemKind::kHardware, ItemKind::kDrawerSlide}) {
    EXPECT_FALSE(Lets(kind, turns_)) << static_cast<int>(kind);
    EXPECT_FALSE(Lets(kind, point_)) << static_cast<int>(kind);
  }
  EXPECT_FALSE(Lets(ItemKind::kDowel, slides_));
  EXPECT_FALSE(Lets(ItemKind::kDrawerSlide, slides_));  // across its way
}

TEST_F(GuidesTest, AnAxisMayBeAtASlant) {
  turns_.axis = Eigen::Vector3d(1, 1, 1).normalized();
  Put({{0.9, 0.9, 0.9}, {1.1, 1.1, 1.1}}, Axis::kX);
  EXPECT_TRUE(Lets(ItemKind::kBolt, turns_));
  Put({{0.9, 0.9, 1.2}, {1.1, 1.1, 1.4}}, Axis::kX);
  EXPECT_FALSE(Lets(ItemKind::kBolt, turns_));
}

// Without kinds, what is on the axis may be a pin.
TEST_F(GuidesTest, WhatNothingIsKnownOfMayLetMove) {
  EXPECT_TRUE(Guides(connection_, turns_, nullptr));
  EXPECT_TRUE(Guides(connection_, slides_, nullptr));
  Put({{0.2, -0.01, 0}, {0.22, 0.01, 0.1}}, Axis::kX);
  EXPECT_FALSE(Guides(connection_, turns_, nullptr));
}

TEST_F(GuidesTest, ASlideIsKeptOnItsWayFromBothSides) {
  const BoundingBox door{{-0.2, -0.01, 0}, {0.2, 0.01, 0.4}};
  const BoundingBox left{{-0.3, -0.01, 0}, {-0.2, 0.01, 1}};
  const BoundingBox right{{0.2, -0.01, 0}, {0.3, 0.01, 1}};
  const BoundingBox wall{{-1, 0.01, 0}, {1, 0.03, 1}}, sill{{-1, -0.1, -0.1}, {1, 0.1, 0}};
  Guidance neighbours;
  neighbours.AddContact(slides_, door, left, Axis::kX);
  neighbours.AddContact(slides_, door, wall, Axis::kY);
  neighbours.AddContact(slides_, door, sill, Axis::kZ);
  EXPECT_FALSE(neighbours.Keeps());
  Guidance guides = neighbours;
  guides.AddContact(slides_, door, right, Axis::kX);
  EXPECT_TRUE(guides.Keeps());
  EXPECT_TRUE(guides.Covers(neighbours));
  EXPECT_FALSE(neighbours.Covers(guides));
  EXPECT_FALSE(Guidance::IsOfWay(slides_, Axis::kZ));
  EXPECT_TRUE(Guidance().Covers(Guidance()));
}

TEST_F(GuidesTest, APivotGoesThroughBoth) {
  const BoundingBox wheel{{-0.2, -0.2, 0}, {0.2, 0.2, 0.02}};
  const BoundingBox axle{{-0.01, -0.01, -0.1}, {0.01, 0.01, 0.1}};
  Guidance pivot;
  pivot.AddContact(turns_, wheel, axle, Axis::kX);
  EXPECT_TRUE(pivot.Keeps());
  Guidance beside;  // a door and its post, whose edges meet on the axis
  beside.AddContact(turns_, {{0, 0, 0}, {0.4, 0.02, 1}}, {{-0.1, 0, 0}, {0, 0.1, 1}}, Axis::kX);
  EXPECT_FALSE(beside.Keeps());
  EXPECT_FALSE(beside.Covers(pivot));
}

// Experts drew them: each joint is let move by something, but for the door between its guides.
TEST(ShippedGuidesTest, EachJointHasSomethingThatLetsItMove) {
  const ItemKindOf kind_of = ShippedOptions().item_kind_of;
  std::set<std::string> without;
  for (const std::string& id : parametric::ShippedAssemblyIds()) {
    for (const Joint& joint : ShippedDesign(id).assembly->assembly().joints) {
      const auto& connections = ShippedConnections(id);
      const bool is_guided =
          std::any_of(connections.begin(), connections.end(), [&](const auto& one) {
            const auto& joints = one.connection.assembly.joints;
            return std::any_of(joints.begin(), joints.end(),
                               [&](const Joint& its) { return its.name == joint.name; }) &&
                   Guides(one.connection, joint, kind_of);
          });
      if (!is_guided) without.insert(id + ": " + joint.name);
    }
  }
  EXPECT_EQ(without, std::set<std::string>{"chicken_coop: pop door"});
}

}  // namespace
}  // namespace mortise::composer
