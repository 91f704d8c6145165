// What joins the parts of assemblies.
#include "services/composer/holding/joints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/connections/connection_assemblies.h"
#include "tests/unit/services/composer/holding/holding_parts.h"

namespace mortise::composer {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<std::string> NamesOf(const Joint& joint) {
  std::vector<std::string> names;
  for (const JoinedPart& part : joint.principals) names.push_back(part.name);
  return names;
}

TEST(JointsTest, DowelledBoardsAreJoinedBySixDowels) {
  parametric::Assembly boards = parametric::DowelledBoards();
  for (parametric::AssemblyPart& part : boards.parts) {
    if (part.connecting) {
      part.item_axes = {parametric::Axis::kZ, parametric::Axis::kX, parametric::Axis::kY};
    }
  }
  ASSERT_OK_AND_ASSIGN(const auto connections, ConnectionsOf("boards", boards));
  const auto joints = JointsOf(boards, connections, TestItems(), TestMaterials());
  ASSERT_THAT(joints, SizeIs(1));
  EXPECT_THAT(NamesOf(joints[0]), ElementsAre("bottom", "wall"));
  EXPECT_NEAR(joints[0].length, 0.6, 1e-9);
  EXPECT_FALSE(joints[0].moves);
  ASSERT_THAT(joints[0].fasteners, SizeIs(6));
  for (const Fastener& dowel : joints[0].fasteners) {
    EXPECT_EQ(dowel.kind, FastenerKind::kDowel);
    EXPECT_EQ(dowel.axis, 2);
    EXPECT_EQ(dowel.diameter, 0.008);
    EXPECT_NEAR(DepthIn(dowel, joints[0].principals[0]), 0.012, 1e-9);
    EXPECT_NEAR(DepthIn(dowel, joints[0].principals[1]), 0.018, 1e-9);
  }
  EXPECT_FALSE(AreCoaxial(joints[0].fasteners[0], joints[0].fasteners[1]));
}

TEST(JointsTest, WhatOnlyTouchesIsAJointWithoutFasteners) {
  const parametric::Assembly table = parametric::TwoLeggedTable();
  ASSERT_OK_AND_ASSIGN(const auto connections, ConnectionsOf("table", table));
  const auto joints = JointsOf(table, connections, TestItems(), TestMaterials());
  ASSERT_THAT(joints, SizeIs(2));
  for (const Joint& joint : joints) EXPECT_THAT(joint.fasteners, IsEmpty());
}

TEST(JointsTest, PartsAreOfMetalByTheirDensity) {
  parametric::Assembly table = parametric::TwoLeggedTable();
  table.parts[0].item = "items/plate";
  table.parts[0].shape = parametric::Angle();
  ASSERT_OK_AND_ASSIGN(const auto connections,
                       ConnectionsOf("table", parametric::TwoLeggedTable()));
  const auto joints = JointsOf(table, connections, TestItems(), TestMaterials());
  for (const JoinedPart& part : joints.at(0).principals) {
    EXPECT_EQ(part.is_metal, part.name == "top");
    EXPECT_EQ(part.is_box, part.name != "top");
  }
}

}  // namespace
}  // namespace mortise::composer
