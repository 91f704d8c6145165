// The solver against exact solutions, balances and invariances.
#include "common/fem/problems/elasticity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "common/fem/elements/stiffness.h"
#include "common/fem/stress/stress_recovery.h"
#include "common/mesh/element_faces.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "tests/unit/services/simulator/analysis/test_cases.h"

namespace mortise::simulator {
namespace {

using mesh::MeshAssembly;
using mesh::TetrahedralMesh;

TetrahedralMesh Mesh(const DesignModel& model, double size, bool quadratic) {
  auto mesh = MeshAssembly(model.surface, {.element_size = size, .quadratic = quadratic});
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return *std::move(mesh);
}

class BothElements : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Elements, BothElements, testing::Bool(),
                         [](const auto& which) { return which.param ? "Quadratic" : "Linear"; });

// Patch test, strong form: a linear displacement field needs no force at inner nodes, and its
// stress comes out exactly everywhere.
TEST_P(BothElements, LinearFieldsAreExact) {
  DesignModel model;
  model.surface = mesh::AssembleBoxes({{"a", {0, 0, 0}, {1, 0.8, 0.6}}});
  model.analysis.materials = {{"test", 1, 3e9, 0.27, 0}};
  const TetrahedralMesh mesh = Mesh(model, 0.25, GetParam());
  Eigen::Matrix3d gradient;
  gradient << 1e-3, 2e-4, -3e-4, 5e-4, -7e-4, 1e-4, 2e-4, 6e-4, 4e-4;
  const Eigen::Matrix3Xd u = gradient * mesh.nodes;
  const auto stiffness = AssembleStiffness(mesh, model.analysis.materials);
  ASSERT_TRUE(stiffness.ok());
  const Eigen::Matrix3Xd force = stiffness->Multiply(u);
  std::vector<bool> outer(mesh.nodes.cols(), false);
  const Eigen::Matrix3Xi outside = mesh::OuterTriangles(mesh);
  for (Eigen::Index k = 0; k < outside.size(); ++k) outer[outside.data()[k]] = true;
  int inner = 0;
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    if (outer[v]) continue;
    ++inner;
    EXPECT_LT(force.col(v).norm(), 1e-12 * force.colwise().norm().sum());
  }
  EXPECT_GT(inner, 3);
  const Matrix6d d = StiffnessMatrix(model.analysis.materials[0]);
  const Eigen::Matrix3d e = 0.5 * (gradient + gradient.transpose());
  Vector6d strain;
  strain << e(0, 0), e(1, 1), e(2, 2), 2 * e(0, 1), 2 * e(1, 2), 2 * e(0, 2);
  const Vector6d expected = d * strain;
  ThreadTeam alone(1);
  const PartNodes nodes(mesh);
  const NodalStress stress = RecoverStress({mesh, model.analysis.materials, u, {}, {}}, nodes,
                                           PartSurface(mesh, nodes), alone);
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    EXPECT_LT((stress.stress.col(v) - expected).norm(), 1e-11 * expected.norm());
  }
}

// Patch test, weak form: a bar pulled evenly, on rollers, in two bonded parts.
TEST_P(BothElements, UniformTensionIsExact) {
  DesignModel model;
  model.surface =
      mesh::AssembleBoxes({{"a", {0, 0, 0}, {0.4, 0.3, 0.2}}, {"b", {0.4, 0, 0}, {1, 0.3, 0.2}}});
  const Material material{"test", 1, 5e9, 0.3, 0};
  model.analysis.materials = {material, material};
  model.analysis.supports = {{{0, "x_min"}, {true, false, false}}};
  for (int part = 0; part < 2; ++part) {
    model.analysis.supports.push_back({{part, "y_min"}, {false, true, false}});
    model.analysis.supports.push_back({{part, "z_min"}, {false, false, true}});
  }
  model.analysis.forces = {{{1, "x_max"}, {6000, 0, 0}}};
  const TetrahedralMesh mesh = Mesh(model, 0.12, GetParam());
  const auto solution = SolveElasticity(mesh, model.analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  const double stress = 6000 / 0.06;
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    const Eigen::Vector3d p = mesh.nodes.col(v);
    const Eigen::Vector3d exact = stress / 5e9 * Eigen::Vector3d(p.x(), -0.3 * p.y(), -0.3 * p.z());
    EXPECT_LT((solution->displacement.col(v) - exact).norm(), 1e-12 * stress / 5e9);
    EXPECT_NEAR(solution->stress(0, v), stress, 1e-8 * stress);
    EXPECT_NEAR(solution->von_mises[v], stress, 1e-8 * stress);
  }
  EXPECT_NEAR(solution->summary.compliance, 6000 * stress / 5e9, 1e-11);
}

TEST_P(BothElements, PressureAllRoundIsHydrostatic) {
  DesignModel model;
  model.surface = mesh::AssembleBoxes({{"a", {0, 0, 0}, {1, 1, 1}}});
  model.analysis.materials = {{"test", 1, 2e9, 0.2, 0}};
  const char* fixed[] = {"x_min", "y_min", "z_min"};
  const char* pressed[] = {"x_max", "y_max", "z_max"};
  for (int k = 0; k < 3; ++k) {
    Support roller{{0, fixed[k]}, {false, false, false}};
    roller.fixed[k] = true;
    model.analysis.supports.push_back(roller);
    model.analysis.pressures.push_back({{0, pressed[k]}, 1e5});
  }
  const TetrahedralMesh mesh = Mesh(model, 0.4, GetParam());
  const auto solution = SolveElasticity(mesh, model.analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_LT(solution->von_mises.maxCoeff(), 1e-5);
  EXPECT_NEAR(solution->stress.topRows(3).maxCoeff(), -1e5, 1e-4);
  EXPECT_NEAR(solution->displacement.minCoeff(), -1e5 / 2e9 * (1 - 2 * 0.2), 1e-15);
}

// Timoshenko's beam with ν = 0, where it is exact but for the ends: δ = F L³/3EI + F L/(⅚ G A).
TEST(Cantilever, MatchesBeamTheoryAndConverges) {
  const double length = 1, side = 0.1, force = 1000, young = 10e9;
  const DesignModel model = Cantilever(length, side, force, 0.0);
  const double exact = force * std::pow(length, 3) / (3 * young * std::pow(side, 4) / 12) +
                       force * length / (5.0 / 6 * 0.5 * young * side * side);
  const auto error = [&](double size, bool quadratic) {
    const TetrahedralMesh mesh = Mesh(model, size, quadratic);
    const auto solution = SolveElasticity(mesh, model.analysis);
    EXPECT_TRUE(solution.ok()) << solution.status();
    // The loads' work is the mean deflection of the loaded face times the force.
    return std::abs(solution->summary.compliance / force / exact - 1);
  };
  const double linear_coarse = error(0.06, false), linear_fine = error(0.03, false);
  const double quadratic_coarse = error(0.1, true), quadratic_fine = error(0.05, true);
  EXPECT_GT(linear_coarse / linear_fine, 2.5);
  EXPECT_LT(quadratic_coarse, 0.02);
  EXPECT_LT(quadratic_fine, 0.005);
  EXPECT_LT(quadratic_fine, 0.1 * linear_fine);
}

// The bending stress M c / I away from the ends.
TEST(Cantilever, HasTheBendingStress) {
  const DesignModel model = Cantilever(1, 0.1, 1000, 0.3);
  const TetrahedralMesh mesh = Mesh(model, 0.04, true);
  const auto solution = SolveElasticity(mesh, model.analysis);
  ASSERT_TRUE(solution.ok());
  int checked = 0;
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    const Eigen::Vector3d p = mesh.nodes.col(v);
    if (p.x() < 0.3 || p.x() > 0.7 || p.z() < 0.0999) continue;
    ++checked;
    const double exact = 1000 * (1 - p.x()) * 0.05 / (std::pow(0.1, 4) / 12);
    EXPECT_NEAR(solution->stress(0, v), exact, 0.03 * exact);
  }
  EXPECT_GT(checked, 10);
}

TEST(Balance, ReactionsCarryEveryLoad) {
  DesignModel model = LoadedTable();
  model.analysis.gravity = {0, 0, -9.80665};
  model.analysis.pressures.push_back({{5, "y_min"}, 250});
  model.analysis.forces.push_back({{2, "x_min"}, {40, -10, 5}});
  const auto analysis = AnalyzeDesign(model, {"mass", "compliance", "strain_energy"}, true, {});
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  const ElasticitySummary& summary = analysis->cases[0].solution.summary;
  const Eigen::Vector3d sum = summary.total_load + summary.total_reaction;
  EXPECT_LT(sum.norm(), 1e-9 * summary.total_load.norm());
  EXPECT_LT(summary.imbalance, 1e-9);
  EXPECT_LT(summary.residual, 1e-9);
  const double weight = analysis->metrics[0].value * 9.80665;
  EXPECT_NEAR(summary.total_load.z(), -1000 - weight + 5, 1e-6);
  EXPECT_NEAR(summary.compliance, 2 * summary.strain_energy, 1e-9 * summary.compliance);
  // Moments balance too.
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  const auto& mesh = *analysis->mesh;
  const auto stiffness = AssembleStiffness(mesh, model.analysis.materials);
  const Eigen::Matrix3Xd all = stiffness->Multiply(analysis->cases[0].solution.displacement);
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    moment += Eigen::Vector3d(mesh.nodes.col(v)).cross(Eigen::Vector3d(all.col(v)));
  }
  EXPECT_LT(moment.norm(), 1e-6);
}

TEST(Invariance, OfMovingAndTurningEverything) {
  DesignModel model = LoadedTable();
  const TetrahedralMesh mesh = Mesh(model, 0, true);
  const auto before = SolveElasticity(mesh, model.analysis);
  ASSERT_TRUE(before.ok());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  TetrahedralMesh moved = mesh;
  moved.nodes = (turn * mesh.nodes).colwise() + Eigen::Vector3d(3, -5, 7);
  model.analysis.forces[0].force = turn * model.analysis.forces[0].force;
  const auto after = SolveElasticity(moved, model.analysis);
  ASSERT_TRUE(after.ok());
  const double size = before->summary.maximum_displacement;
  EXPECT_LT((after->displacement - turn * before->displacement).cwiseAbs().maxCoeff(), 1e-7 * size);
  EXPECT_LT((after->von_mises - before->von_mises).cwiseAbs().maxCoeff(),
            1e-6 * before->von_mises.maxCoeff());
}

TEST(Linearity, TwiceTheLoadTwiceTheDeflectionSuperposed) {
  const DesignModel model = LoadedTable();
  const TetrahedralMesh mesh = Mesh(model, 0, false);
  AnalysisCase first = model.analysis, second = model.analysis, both = model.analysis;
  second.forces = {{{1, "x_min"}, {100, 0, 0}}};
  both.forces.push_back(second.forces[0]);
  both.forces[0].force *= 2;
  const auto a = SolveElasticity(mesh, first), b = SolveElasticity(mesh, second),
             c = SolveElasticity(mesh, both);
  ASSERT_TRUE(a.ok() && b.ok() && c.ok());
  EXPECT_LT((c->displacement - 2 * a->displacement - b->displacement).norm(),
            1e-9 * c->displacement.norm());
}

TEST(Supports, PrescribedDisplacementStretchesTheBar) {
  DesignModel model = Cantilever(1, 0.1, 0, 0.0);
  model.analysis.forces.clear();
  model.analysis.supports.push_back({{0, "x_max"}, {true, false, false}, {1e-4, 0, 0}});
  const TetrahedralMesh mesh = Mesh(model, 0.1, true);
  const auto solution = SolveElasticity(mesh, model.analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_NEAR(solution->stress(0, 5), 1e-4 * 10e9, 1);
  EXPECT_NEAR(solution->summary.strain_energy, 0.5 * 1e-8 * 10e9 * 0.01, 1e-9);
  EXPECT_LT(solution->summary.imbalance, 1e-9);
}

// Atoms are larger, but the case is linear.
TEST(Linearity, HoldsForCausesOfAnySize) {
  for (const double size : {1.0, 1e-9, 1e-12, 1e-15}) {
    DesignModel model = Cantilever(1, 0.1, 0, 0.0);
    model.analysis.forces.clear();
    model.analysis.gravity = {0, 0, -size};
    const TetrahedralMesh mesh = Mesh(model, 0.1, true);
    const double weight = model.analysis.materials[0].density * 0.01 * size;
    auto solution = SolveElasticity(mesh, model.analysis);
    ASSERT_TRUE(solution.ok()) << solution.status();
    EXPECT_NEAR(solution->summary.total_load.z(), -weight, 1e-9 * weight) << size;
    model.analysis.gravity.setZero();
    model.analysis.supports.push_back({{0, "x_max"}, {true, false, false}, {1e-4 * size, 0, 0}});
    solution = SolveElasticity(mesh, model.analysis);
    ASSERT_TRUE(solution.ok()) << solution.status();
    const double stress = 1e-4 * size * 10e9;
    EXPECT_NEAR(solution->stress(0, 5), stress, 1e-6 * stress) << size;
    EXPECT_LT(solution->summary.imbalance, 1e-9) << size;
    const double reaction = solution->reaction.row(0).cwiseAbs().sum() / 2;
    EXPECT_NEAR(reaction, 0.01 * stress, 1e-6 * 0.01 * stress) << size;
  }
}

TEST(Determinism, TheSameCaseGivesTheSameBits) {
  const DesignModel model = LoadedTable();
  const auto first = AnalyzeDesign(model, {"max_displacement", "compliance"}, false, {});
  const auto second = AnalyzeDesign(model, {"max_displacement", "compliance"}, false, {});
  ASSERT_TRUE(first.ok() && second.ok());
  for (int k = 0; k < 2; ++k) EXPECT_EQ(first->metrics[k].value, second->metrics[k].value);
}

}  // namespace
}  // namespace mortise::simulator
