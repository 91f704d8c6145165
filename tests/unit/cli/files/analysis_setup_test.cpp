#include "cli/files/analysis_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "common/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;

absl::Status FaultOf(const SetupFlags& flags) {
  FieldSources sources;
  return SetupOf(flags, sources).status();
}

TEST(AnalysisSetupFlags, GiveSupportsAndForces) {
  FieldSources sources;
  const auto setup = SetupOf(
      {.supports = {"leg 1/z_min"}, .loads = {"seat/z_max=0, 0.5kN,-100N"}, .file = ""}, sources);
  ASSERT_TRUE(setup.ok()) << setup.status();
  ASSERT_EQ(setup->boundary_conditions_size(), 2);
  EXPECT_EQ(setup->boundary_conditions(0).kind(), v1::BoundaryCondition::FIXED);
  EXPECT_EQ(setup->boundary_conditions(0).face(), "leg 1/z_min");
  const v1::EvaluatedBoundaryCondition& load = setup->boundary_conditions(1);
  EXPECT_EQ(load.kind(), v1::BoundaryCondition::FORCE);
  EXPECT_EQ(load.face(), "seat/z_max");
  EXPECT_EQ(load.force().x(), 0);
  EXPECT_EQ(load.force().y(), 500);
  EXPECT_EQ(load.force().z(), -100);
  const absl::Status told =
      sources.Name(InvalidField("setup.boundary_conditions[1].face", "is of no part"));
  EXPECT_EQ(DetailOf(told).field, "--load seat/z_max");
}

TEST(AnalysisSetupFlags, FollowWhatAFileGives) {
  const mortise::testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "setup.textproto";
  std::ofstream(file) << "boundary_conditions { kind: GRAVITY acceleration { z: -9.81 } }";
  FieldSources sources;
  const auto setup = SetupOf({.supports = {"z_min"}, .loads = {}, .file = file}, sources);
  ASSERT_TRUE(setup.ok()) << setup.status();
  ASSERT_EQ(setup->boundary_conditions_size(), 2);
  EXPECT_EQ(setup->boundary_conditions(0).acceleration().z(), -9.81);
  EXPECT_EQ(setup->boundary_conditions(1).face(), "z_min");
  const absl::Status of_file =
      sources.Name(InvalidField("setup.boundary_conditions[0].kind", "is none"));
  EXPECT_EQ(DetailOf(of_file).field, file.string() + ": boundary_conditions[0].kind");
  const absl::Status of_flag =
      sources.Name(InvalidField("setup.boundary_conditions[1].face", "is none"));
  EXPECT_EQ(DetailOf(of_flag).field, "--support z_min");
}

TEST(AnalysisSetupFlags, RefuseWhatIsNoForce) {
  EXPECT_THAT(std::string(FaultOf({.supports = {}, .loads = {"seat"}, .file = ""}).message()),
              HasSubstr("FACE=X,Y,Z"));
  EXPECT_THAT(std::string(FaultOf({.supports = {}, .loads = {"seat=1,2"}, .file = ""}).message()),
              HasSubstr("--load seat"));
  EXPECT_THAT(
      std::string(FaultOf({.supports = {}, .loads = {"seat=0,0,5kg"}, .file = ""}).message()),
      HasSubstr("it is in N"));
}

}  // namespace
}  // namespace mortise::cli
