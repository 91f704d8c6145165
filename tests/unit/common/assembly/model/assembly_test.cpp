// What is wrong with assemblies, each fault with its place.
#include "common/assembly/model/assembly.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/errors.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

TEST(AssemblyTest, EveryFaultIsFoundWithItsPlace) {
  Assembly bad = ChestWithLid();
  bad.groups[1].parent = 2;  // and 2 lies in 1: a circle
  bad.parts[0].group = 17;
  bad.parts[1].name = "bottom";
  bad.parts[3].box.maximum.x() = -1;
  bad.parts[4].limits[0] = {2, 1};
  bad.parts[5].limits[1] = {0.1, 0.2};
  bad.parts[6].limits[2] = {std::nan(""), 1};
  bad.parts[2].prominent_planes = {{"edge", Axis::kX, 0.5}, {"ledge", Axis::kX, 1e6}};
  bad.joints[0].lower = 1;
  bad.joints.push_back(bad.joints[0]);
  bad.joints[1].axis = {1, 1, 0};
  std::vector<std::string> places;
  for (const FieldViolation& finding : ValidateAssembly(bad)) places.push_back(finding.field);
  EXPECT_THAT(places, ::testing::IsSupersetOf(
                          {"groups[1].parent", "groups[2].parent", "parts[0].group",
                           "parts[2].name", "parts[2].prominent_planes[1].position", "parts[3].box",
                           "parts[4].limits.x", "parts[5].limits.y", "parts[6].limits.z",
                           "joints[0].lower", "joints[1].group", "joints[1].axis"}));
  EXPECT_TRUE(ValidateAssembly(ChestWithLid()).empty());
  EXPECT_TRUE(ValidateAssembly(TwoLeggedTable()).empty());
}

TEST(AssemblyTest, JointsIncludeTheDrawnPoseAndMoveSomething) {
  Assembly chest = ChestWithLid();
  chest.joints[0].upper = -0.2;
  auto findings = ValidateAssembly(chest);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].field, "joints[0].lower");
  chest = ChestWithLid();
  chest.groups.push_back({"nothing", 0});
  chest.joints[0].group = 4;
  findings = ValidateAssembly(chest);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].field, "joints[0].group");
  chest = ChestWithLid();
  chest.joints[0].rest_poses = {{"beyond", {-1.7, 0, 0}}, {"aside", {-1, 0.1, 0}}};
  findings = ValidateAssembly(chest);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].field, "joints[0].rest_poses[0]");
  EXPECT_EQ(findings[1].field, "joints[0].rest_poses[1]");
}

TEST(AssemblyTest, NothingLiesBeyondAllMeasure) {
  Assembly table = TwoLeggedTable();
  table.parts[0].box.maximum.x() = 1e300;
  ASSERT_FALSE(ValidateAssembly(table).empty());
  EXPECT_EQ(ValidateAssembly(table)[0].field, "parts[0].box");
}

}  // namespace
}  // namespace mortise::parametric
