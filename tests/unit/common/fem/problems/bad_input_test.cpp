// What the simulator refuses, and how it says so.
#include <gtest/gtest.h>

#include <limits>

#include "common/base/errors.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "tests/unit/services/simulator/analysis/test_cases.h"

namespace mortise::simulator {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

absl::Status Solve(const DesignModel& model) {
  return AnalyzeDesign(model, {"max_displacement"}, false, {}).status();
}

std::string Field(const DesignModel& model) {
  const absl::Status status = Solve(model);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  return DetailOf(status).field;
}

TEST(BadInput, NamesTheFieldAtFault) {
  DesignModel model = LoadedTable();
  model.analysis.materials.pop_back();
  EXPECT_EQ(Field(model), "materials");
  model = LoadedTable();
  model.analysis.materials[3].poissons_ratio = 0.5;
  EXPECT_EQ(Field(model), "materials[3].poissons_ratio");
  model.analysis.materials[3].poissons_ratio = kNan;
  EXPECT_EQ(Field(model), "materials[3].poissons_ratio");
  model = LoadedTable();
  model.analysis.materials[0].youngs_modulus = 0;
  EXPECT_EQ(Field(model), "materials[0].youngs_modulus");
  model.analysis.materials[0].youngs_modulus = -1;
  EXPECT_EQ(Field(model), "materials[0].youngs_modulus");
  model = LoadedTable();
  model.analysis.materials[0].density = 0;
  EXPECT_EQ(Field(model), "materials[0].density");
  model = LoadedTable();
  model.analysis.forces[0].force.y() = kNan;
  EXPECT_EQ(Field(model), "forces[0].force");
  model = LoadedTable();
  model.analysis.pressures.push_back({{0, "z_max"}, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(Field(model), "pressures[0].pressure");
  model = LoadedTable();
  model.analysis.gravity.x() = kNan;
  EXPECT_EQ(Field(model), "gravity");
  model = LoadedTable();
  model.analysis.supports[2].face.name = "sole";
  EXPECT_EQ(Field(model), "supports[2].face");
  model = LoadedTable();
  model.analysis.forces[0].face = {1, "z_max"};  // under the top
  EXPECT_EQ(Field(model), "forces[0].face");
  model = LoadedTable();
  model.analysis.forces[0].face.part = 99;
  EXPECT_EQ(Field(model), "forces[0].face");
}

TEST(BadInput, MetricsMustBeOffered) {
  const DesignModel model = LoadedTable();
  EXPECT_EQ(DetailOf(AnalyzeDesign(model, {}, false, {}).status()).field, "metrics");
  EXPECT_EQ(DetailOf(AnalyzeDesign(model, {"mass", "beauty"}, false, {}).status()).field,
            "metrics[1]");
}

TEST(RigidMotion, WithoutSupportsIsNamed) {
  DesignModel model = LoadedTable();
  model.analysis.supports.clear();
  const absl::Status status = Solve(model);
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(status).reason, "RIGID_MOTION");
  EXPECT_NE(status.message().find("'top'"), std::string::npos) << status;
}

TEST(RigidMotion, OfALoosePartIsNamed) {
  DesignModel model;
  model.surface =
      mesh::AssembleBoxes({{"base", {0, 0, 0}, {1, 1, 0.1}}, {"stray", {0, 0, 0.5}, {1, 1, 0.6}}});
  model.analysis.materials.assign(2, Spruce());
  model.analysis.supports.push_back({{0, "z_min"}});
  const absl::Status status = Solve(model);
  EXPECT_EQ(DetailOf(status).reason, "RIGID_MOTION");
  EXPECT_NE(status.message().find("part 'stray' is free"), std::string::npos) << status;
  EXPECT_EQ(status.message().find("base"), std::string::npos) << status;
}

// A flap whose lower edge lies along the upper edge of the base, and nothing else.
TEST(RigidMotion, OfAPartOnAHingeIsNamed) {
  DesignModel model;
  model.surface =
      mesh::AssembleBoxes({{"base", {0, 0, 0}, {1, 1, 0.1}}, {"flap", {1, 0, 0.1}, {2, 1, 0.3}}});
  model.analysis.materials.assign(2, Spruce());
  model.analysis.supports.push_back({{0, "z_min"}});
  const absl::Status status = Solve(model);
  EXPECT_EQ(DetailOf(status).reason, "RIGID_MOTION");
  EXPECT_NE(status.message().find("part 'flap' is free to rotate about y through (1000, 500, 100)"),
            std::string::npos)
      << status;
  EXPECT_EQ(status.message().find("base"), std::string::npos) << status;
}

TEST(RigidMotion, SaysWhichWay) {
  DesignModel model;
  model.surface = mesh::AssembleBoxes({{"block", {0, 0, 0}, {1, 0.5, 0.2}}});
  model.analysis.materials = {Spruce()};
  model.analysis.supports.push_back({{0, "z_min"}, {true, false, true}});
  absl::Status status = Solve(model);
  EXPECT_NE(status.message().find("move along y"), std::string::npos) << status;
  model.analysis.supports = {{{0, "z_min"}, {false, false, true}},
                             {{0, "x_min"}, {true, false, false}}};
  model.analysis.supports[0].fixed = {false, false, true};
  status = Solve(model);
  EXPECT_NE(status.message().find("move along y"), std::string::npos) << status;
}

TEST(RigidMotion, AHingeIsAMechanism) {
  // Two blocks that share one edge only.
  DesignModel model;
  model.surface = mesh::AssembleBoxes({{"a", {0, 0, 0}, {1, 1, 1}}, {"b", {1, 0, 1}, {2, 1, 2}}});
  model.analysis.materials.assign(2, Spruce());
  model.analysis.supports.push_back({{0, "z_min"}});
  model.analysis.forces.push_back({{1, "x_max"}, {0, 0, -1}});
  const absl::Status status = Solve(model);
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
}

TEST(BadInput, InvertedAndFlatElementsAreFound) {
  const DesignModel model = LoadedTable();
  auto mesh = mesh::MeshAssembly(model.surface, {.quadratic = false});
  ASSERT_TRUE(mesh.ok());
  mesh::TetrahedralMesh inverted = *mesh;
  inverted.tetrahedra.col(17).head(2).swap(inverted.tetrahedra.col(17).segment(2, 2));
  std::swap(inverted.tetrahedra(0, 17), inverted.tetrahedra(1, 17));
  const absl::Status status = SolveElasticity(inverted, model.analysis).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  EXPECT_EQ(DetailOf(status).field, "tetrahedra[17]");
  mesh::TetrahedralMesh flat = *mesh;
  flat.tetrahedra(3, 5) = flat.tetrahedra(2, 5);
  EXPECT_EQ(DetailOf(SolveElasticity(flat, model.analysis).status()).field, "tetrahedra[5]");
  mesh::TetrahedralMesh broken = *mesh;
  broken.nodes(0, 9) = kNan;
  EXPECT_FALSE(SolveElasticity(broken, model.analysis).ok());
}

TEST(BadInput, ContradictingSupportsAreRefused) {
  DesignModel model = Cantilever(1, 0.1, 10, 0.3);
  model.analysis.supports.push_back({{0, "y_min"}, {true, true, true}, {0.1, 0, 0}});
  EXPECT_EQ(Field(model), "supports[1].displacement");
}

TEST(BadInput, MemoryLimitIsHonoured) {
  DesignAnalysisOptions options;
  options.elasticity.solver.memory_limit = 1e5;
  const auto status = AnalyzeDesign(LoadedTable(), {"compliance"}, false, options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
}

}  // namespace
}  // namespace mortise::simulator
