// What people reported of mechanisms and thin sheets, from ../shared/data/field/fem.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/unit/services/simulator/worker/analysed_mesh.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;

std::string FieldFile(const std::string& name) {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  const auto path =
      std::filesystem::path(source == nullptr ? "." : source) / "../shared/data/field/fem" / name;
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.good()) << path;
  std::stringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

Analysed AnalyseField(const std::string& mesh_file, v1::MeshCase mesh_case) {
  const auto mesh = mesh::ReadGroupedMesh(FieldFile(mesh_file));
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return Analyse(*mesh, mesh_case);
}

TEST(FieldMechanisms, AHingeIsToldWhateverTheSolverAndTheLoad) {
  for (const char* name : {"hinge-load-along-hinge.json", "hinge-load-on-held-cube.json"}) {
    for (const v1::SolverKind solver : {v1::DIRECT, v1::ITERATIVE}) {
      v1::MeshCase mesh_case = Case(FieldFile(name));
      mesh_case.set_solver(solver);
      const absl::Status status = AnalyseField("hinge.msh", mesh_case).analysis.status();
      EXPECT_EQ(DetailOf(status).reason, "RIGID_MOTION") << status;
      EXPECT_EQ(DetailOf(status).field, "case.supports");
      EXPECT_THAT(std::string(status.message()),
                  HasSubstr("is free to rotate about y through (1000, 500, 1000) mm"));
    }
  }
}

TEST(FieldMechanisms, AHingesModesBeginWithItsMotion) {
  const Analysed analysed = AnalyseField("hinge.msh", Case(FieldFile("hinge-modes.json")));
  ASSERT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
  const std::vector<ModeOutcome>& modes = analysed.analysis->modes;
  ASSERT_EQ(modes.size(), 5);
  EXPECT_TRUE(modes[0].rigid);
  EXPECT_EQ(modes[0].frequency, 0);
  const double expected[] = {0, 90.5, 135.1, 283.2};
  for (int m = 1; m < 4; ++m) EXPECT_NEAR(modes[m].frequency, expected[m], 0.05) << m;
  ASSERT_EQ(analysed.analysis->notes.size(), 1);
  EXPECT_THAT(analysed.analysis->notes[0], HasSubstr("1 mode at 0 Hz"));
}

TEST(FieldMechanisms, AThinSheetIsSolved) {
  for (const v1::SolverKind solver : {v1::DIRECT, v1::ITERATIVE}) {
    v1::MeshCase mesh_case = Case(FieldFile("sheet.json"));
    mesh_case.set_solver(solver);
    const Analysed analysed = AnalyseField("sheet.msh", mesh_case);
    ASSERT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
    EXPECT_NEAR(analysed.analysis->cases[0].summary.maximum_displacement, 19.58e-3, 0.01e-3);
  }
}

}  // namespace
}  // namespace mortise::simulator
