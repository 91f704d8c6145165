// Heat conduction and vibration against exact answers and balances.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "common/base/errors.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/problems/heat_conduction.h"
#include "common/fem/problems/modal_analysis.h"
#include "tests/unit/common/fem/problems/structured_mesh.h"

namespace mortise::simulator {
namespace {

Material Steel() { return {"steel", 7800, 210e9, 0.3, 250e6, 1.2e-5, 50}; }

mesh::MappedBox Box(std::array<int, 3> cells, const Eigen::Vector3d& size) {
  mesh::MappedBox box;
  for (int d = 0; d < 3; ++d) box.ticks[d] = mesh::Ticks(cells[d]);
  box.place = [size](const Eigen::Vector3d& p) -> Eigen::Vector3d { return p.cwiseProduct(size); };
  return box;
}

// A wall: fixed inside, convection outside.
TEST(Heat, FallsEvenlyThroughAWall) {
  for (const bool quadratic : {false, true}) {
    const auto mesh = mesh::MeshMappedBox(Box({3, 2, 2}, {0.1, 1, 1}), quadratic);
    HeatCase heat;
    heat.materials = {Steel()};
    heat.temperatures = {{{0, "u_min"}, 80}};
    heat.convections = {{{0, "u_max"}, 500, 20}};
    const auto solution = SolveHeat(mesh, heat);
    ASSERT_TRUE(solution.ok()) << solution.status();
    const double flux = 60 / (0.1 / 50 + 1.0 / 500);
    for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
      EXPECT_NEAR(solution->temperature[v], 80 - flux * mesh.nodes(0, v) / 50, 1e-10);
    }
    EXPECT_NEAR(solution->convected[0], flux, 1e-8 * flux);
    EXPECT_NEAR(solution->reaction.sum(), flux, 1e-8 * flux);
    EXPECT_LT(solution->imbalance, 1e-11);
    const Eigen::Matrix3Xd at_points =
        HeatFluxAtPoints(mesh, heat.materials, solution->temperature);
    EXPECT_LT((at_points.colwise() - Eigen::Vector3d(flux, 0, 0)).cwiseAbs().maxCoeff(),
              1e-8 * flux);
  }
}

// A source and a flux: a parabola, which quadratic elements hold exactly.
TEST(Heat, OfASourceIsAParabola) {
  const auto mesh = mesh::MeshMappedBox(Box({3, 2, 2}, {0.3, 0.2, 0.1}), true);
  HeatCase heat;
  heat.materials = {Steel()};
  heat.temperatures = {{{0, "u_min"}, 10}};
  heat.fluxes = {{{0, "u_max"}, 4e3}};
  heat.sources = {{0, 2e5}};
  const auto solution = SolveHeat(mesh, heat);
  ASSERT_TRUE(solution.ok()) << solution.status();
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    const double x = mesh.nodes(0, v);
    EXPECT_NEAR(solution->temperature[v], 10 + (4e3 * x + 2e5 * (0.3 * x - 0.5 * x * x)) / 50,
                1e-9);
  }
  EXPECT_NEAR(solution->supplied, 4e3 * 0.02 + 2e5 * 0.006, 1e-8);
  EXPECT_LT(solution->imbalance, 1e-11);
}

TEST(Heat, OfAFaintSourceIsTold) {
  const auto mesh = mesh::MeshMappedBox(Box({3, 2, 2}, {0.3, 0.2, 0.1}), true);
  HeatCase heat;
  heat.materials = {Steel()};
  heat.temperatures = {{{0, "u_min"}, 0}};
  heat.sources = {{0, 1e-13}};
  const auto solution = SolveHeat(mesh, heat);
  ASSERT_TRUE(solution.ok()) << solution.status();
  const double warmest = 1e-13 * 0.5 * 0.3 * 0.3 / 50;
  EXPECT_NEAR(solution->temperature.maxCoeff(), warmest, 1e-9 * warmest);
  EXPECT_NEAR(solution->supplied, 1e-13 * 0.006, 1e-22);
}

// In wood, heat runs along the grain: a linear temperature drives a flux at an angle to its slope.
TEST(Heat, FollowsTheGrain) {
  Material wood{"spruce", 450, 0, 0, 0};
  Orthotropy& grain = wood.orthotropy.emplace();
  grain.conductivity = {0.3, 0.15, 0.12};
  grain.axes = GrainAxes({1, 1, 0}, {0, 0, 1});
  const auto mesh = mesh::MeshMappedBox(Box({2, 2, 2}, {1, 1, 1}), false);
  const Eigen::VectorXd temperature = mesh.nodes.row(0).transpose() * 10;
  const Eigen::Matrix3Xd flux = HeatFluxAtPoints(mesh, {wood}, temperature);
  const Eigen::Vector3d expected = -10 * Eigen::Vector3d(0.21, 0.09, 0);
  EXPECT_LT((flux.colwise() - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Heat, WhatIsMissingOrWrongIsNamed) {
  const auto mesh = mesh::MeshMappedBox(Box({1, 1, 1}, {1, 1, 1}), false);
  HeatCase heat;
  heat.materials = {Steel()};
  heat.fluxes = {{{0, "u_max"}, 100}};
  absl::Status status = SolveHeat(mesh, heat).status();
  EXPECT_EQ(DetailOf(status).reason, "FREE_TEMPERATURE");
  EXPECT_NE(status.message().find("part 'body' is without"), std::string::npos) << status;
  const auto field = [&](const HeatCase& wrong) {
    return DetailOf(SolveHeat(mesh, wrong).status()).field;
  };
  heat.temperatures = {{{0, "u_min"}, 100}, {{0, "v_min"}, 50}};
  EXPECT_EQ(field(heat), "temperatures[1].temperature");
  heat.temperatures = {{{0, "sole"}, 100}};
  EXPECT_EQ(field(heat), "temperatures[0].face");
  heat.temperatures = {{{0, "u_min"}, NAN}};
  EXPECT_EQ(field(heat), "temperatures[0].temperature");
  heat.temperatures = {{{0, "u_min"}, 100}};
  heat.convections = {{{0, "w_max"}, -3, 20}};
  EXPECT_EQ(field(heat), "convections[0].coefficient");
  heat.convections.clear();
  heat.fluxes[0].flux = INFINITY;
  EXPECT_EQ(field(heat), "fluxes[0].flux");
  heat.fluxes.clear();
  heat.sources = {{3, 1}};
  EXPECT_EQ(field(heat), "sources[0].part");
  heat.sources.clear();
  heat.materials[0].conductivity = 0;
  EXPECT_EQ(field(heat), "materials[0].conductivity");
}

// φᵢᵀ M φⱼ = δᵢⱼ for all modes, rigid ones included.
void ExpectOrthonormal(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                       const ModalSolution& solution) {
  const auto stiffness = AssembleStiffness(mesh, materials);
  ThreadTeam alone(1);
  const auto mass = AssembleMass(mesh, materials, {}, stiffness->pattern(), alone);
  ASSERT_TRUE(stiffness.ok() && mass.ok());
  for (std::size_t i = 0; i < solution.modes.size(); ++i) {
    const Eigen::Matrix3Xd product = mass->Multiply(solution.modes[i].shape);
    for (std::size_t j = 0; j <= i; ++j) {
      EXPECT_NEAR((solution.modes[j].shape.array() * product.array()).sum(), i == j, 1e-6)
          << i << " " << j;
    }
  }
}

// A bar that can only move along itself, fixed at one end: f = (2k − 1) c / 4L with c² = E/ρ.
TEST(Modes, OfARodAreItsOvertones) {
  const auto box = Box({24, 1, 1}, {2, 0.05, 0.05});
  const auto mesh = mesh::MeshMappedBox(box, true);
  Support guide{{}, {false, true, true}}, end{{0, "u_min"}};
  guide.nodes = mesh::NodesWhere(box, true, [](const Eigen::Vector3d&) { return true; });
  const std::vector<Material> materials{{"test", 2000, 8e9, 0, 0}};
  ModalOptions options;
  options.count = 4;
  const auto solution = FindModes(mesh, materials, {guide, end}, options);
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_EQ(solution->rigid_motions, 0);
  EXPECT_NEAR(solution->mass, 2000 * 2 * 0.0025, 1e-9);
  ASSERT_EQ(solution->modes.size(), 4u);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(solution->modes[k].frequency, (2 * k + 1) * 2000.0 / 8,
                1e-4 * 2000 / 8 * (2 * k + 1));
    EXPECT_LT(solution->modes[k].residual, 1e-6);
  }
  ExpectOrthonormal(mesh, materials, *solution);
}

// A free slender beam of square section: six rigid motions, then pairs of equal bending modes, near
// Euler's and Bernoulli's (4.730² / 2π L²) √(EI/ρA), less what shear and turning take.
TEST(Modes, OfAFreeBeamComeInPairs) {
  const auto mesh = mesh::MeshMappedBox(Box({20, 2, 2}, {2, 0.08, 0.08}), true);
  const std::vector<Material> materials{Steel()};
  ModalOptions options;
  options.count = 4;
  const auto solution = FindModes(mesh, materials, {}, options);
  ASSERT_TRUE(solution.ok()) << solution.status();
  ASSERT_EQ(solution->rigid_motions, 6);
  ASSERT_EQ(solution->modes.size(), 10u);
  const double bar = std::sqrt(210e9 * 0.08 * 0.08 / 12 / 7800) / (2 * M_PI * 4);
  const double expected[] = {4.73004 * 4.73004 * bar, 7.85320 * 7.85320 * bar};
  for (int k = 0; k < 4; ++k) {
    const Mode& mode = solution->modes[6 + k];
    EXPECT_FALSE(mode.rigid);
    EXPECT_LT(mode.frequency, expected[k / 2]);
    EXPECT_GT(mode.frequency, (k < 2 ? 0.985 : 0.96) * expected[k / 2]);
    EXPECT_LT(mode.residual, 1e-5);
  }
  EXPECT_NEAR(solution->modes[6].frequency, solution->modes[7].frequency,
              2e-3 * solution->modes[6].frequency);
  ExpectOrthonormal(mesh, materials, *solution);
}

// A free cube, whose modes are multiple by symmetry but for the mesh: the same on any number of
// threads, and shapes strained no more by being turned in space.
TEST(Modes, AreTheSameOnAnyNumberOfThreadsAndPlanes) {
  const auto mesh = mesh::MeshMappedBox(Box({4, 4, 4}, {1, 1, 1}), false);
  const std::vector<Material> materials{Steel()};
  ModalOptions options;
  options.count = 5;
  const auto one = FindModes(mesh, materials, {}, options);
  options.threads = 3;
  const auto three = FindModes(mesh, materials, {}, options);
  ASSERT_TRUE(one.ok() && three.ok()) << one.status();
  for (std::size_t k = 0; k < one->modes.size(); ++k) {
    EXPECT_EQ(one->modes[k].frequency, three->modes[k].frequency);
  }
  // On a plane of symmetry that no axis is square to, the same as on one that is.
  Support symmetric{{0, "u_min"}};
  symmetric.symmetric = true;
  const auto straight = FindModes(mesh, materials, {symmetric}, options);
  mesh::TetrahedralMesh turned = mesh;
  const Eigen::AngleAxisd turn(0.5, Eigen::Vector3d(1, 2, 3).normalized());
  turned.nodes = turn.toRotationMatrix() * mesh.nodes;
  const auto inclined = FindModes(turned, materials, {symmetric}, options);
  ASSERT_TRUE(straight.ok() && inclined.ok()) << inclined.status();
  ASSERT_EQ(straight->rigid_motions, 3);
  ASSERT_EQ(inclined->rigid_motions, 3);
  for (std::size_t k = 0; k < straight->modes.size(); ++k) {
    EXPECT_NEAR(straight->modes[k].frequency, inclined->modes[k].frequency,
                1e-6 * straight->modes[k].frequency);
  }
}

TEST(Modes, AskedForMustBeThere) {
  const auto mesh = mesh::MeshMappedBox(Box({1, 1, 1}, {1, 1, 1}), false);
  ModalOptions options;
  for (const int count : {0, -1, 17, 1000}) {
    options.count = count;
    EXPECT_EQ(DetailOf(FindModes(mesh, {Steel()}, {}, options).status()).field, "count") << count;
  }
  options.count = 3;
  EXPECT_TRUE(FindModes(mesh, {Steel()}, {}, options).ok());
}

}  // namespace
}  // namespace mortise::simulator
