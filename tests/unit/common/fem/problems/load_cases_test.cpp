// Loads, supports and load cases against balances and exact answers.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "common/base/errors.h"
#include "common/fem/problems/elasticity.h"
#include "tests/unit/common/fem/problems/structured_mesh.h"

namespace mortise::simulator {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Material Steel() { return {"steel", 7800, 210e9, 0.3, 250e6, 1.2e-5, 50}; }

// A bar along x, of length 1 and section 0.2 × 0.1, turned about z and away.
mesh::MappedBox Bar(int n, double angle = 0) {
  mesh::MappedBox box;
  box.ticks = {mesh::Ticks(4 * n), mesh::Ticks(n), mesh::Ticks(n)};
  box.place = [angle](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const Eigen::Vector3d at(p.x(), 0.2 * p.y(), 0.1 * p.z());
    if (angle == 0) return at;
    return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * at;
  };
  return box;
}

Support Symmetric(const char* face) {
  Support support{{0, face}};
  support.symmetric = true;
  return support;
}

Eigen::Vector3d MomentOf(const mesh::TetrahedralMesh& mesh, const Eigen::Matrix3Xd& forces) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    moment += Eigen::Vector3d(mesh.nodes.col(v)).cross(Eigen::Vector3d(forces.col(v)));
  }
  return moment;
}

// A face that goes round an edge is held along the normals of both of its planes there, as two
// faces are.
TEST(Supports, SymmetryOfSeveralPlanesHoldsTheirSharedEdgesTwice) {
  for (const double angle : {0.0, 0.3}) {
    mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(Bar(2, angle), true);
    for (mesh::AssemblyFace& face : mesh.faces) {
      const std::vector<mesh::NamedFace> origins = face.origins;
      for (const mesh::NamedFace& origin : origins) {
        if (origin.name == "u_min" || origin.name == "v_min" || origin.name == "w_min") {
          face.origins.push_back({0, "corner"});
        }
      }
    }
    AnalysisCase analysis;
    analysis.materials = {Steel()};
    analysis.forces = {{{0, "u_max"}, {100, -200, 300}}};
    analysis.supports = {Symmetric("u_min"), Symmetric("v_min"), Symmetric("w_min")};
    const auto separate = SolveElasticity(mesh, analysis);
    analysis.supports = {Symmetric("corner")};
    const auto together = SolveElasticity(mesh, analysis);
    ASSERT_TRUE(separate.ok() && together.ok()) << separate.status() << together.status();
    EXPECT_LT((together->displacement - separate->displacement).norm(),
              1e-9 * separate->displacement.norm());
  }
}

// Everything at once: reactions balance forces and moments.
TEST(Loads, AreBalancedByReactions) {
  for (const bool quadratic : {false, true}) {
    const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(Bar(2), quadratic);
    AnalysisCase analysis;
    analysis.materials = {Steel()};
    analysis.supports = {{{0, "u_min"}}};
    analysis.forces = {{{0, "u_max"}, {100, -200, 300}}};
    analysis.pressures = {{{0, "w_max"}, 1e4}};
    analysis.gravity = {0, 0, -9.80665};
    analysis.tractions = {{{0, "v_max"}, [](const Eigen::Vector3d& x, const Eigen::Vector3d& n) {
                             return Eigen::Vector3d(1e3 * x.x() * n + Eigen::Vector3d(0, 0, 50));
                           }}};
    analysis.point_forces = {{{0.71, 0.13, 0.06}, {5e3, 1e3, -2e3}}};
    analysis.rotation = Rotation{{0, 0, -0.3}, {0, 20, 0}};
    analysis.body_force = [](const Eigen::Vector3d& x) {
      return Eigen::Vector3d(0, 1e4 * x.x(), 0);
    };
    analysis.temperature = Eigen::VectorXd::LinSpaced(mesh.nodes.cols(), 10, 60);
    const auto solution = SolveElasticity(mesh, analysis);
    ASSERT_TRUE(solution.ok()) << solution.status();
    EXPECT_LT(solution->summary.imbalance, 1e-11);
    EXPECT_LT(solution->summary.residual, 1e-11);
    // Forces by hand, but for those of the temperature, which add up to nothing.
    const double mass = 7800 * 0.02, volume = 0.02;
    const Eigen::Vector3d centre(0.5, 0.1, 0.05);
    const Eigen::Vector3d arm = centre - Eigen::Vector3d(0, 0, -0.3);
    const Eigen::Vector3d expected =
        Eigen::Vector3d(100, -200, 300) + Eigen::Vector3d(0, 0, -1e4 * 0.2) +
        mass * Eigen::Vector3d(0, 0, -9.80665) + Eigen::Vector3d(0, 1e3 * 0.5 * 0.1, 50 * 0.1) +
        Eigen::Vector3d(5e3, 1e3, -2e3) + mass * 400 * Eigen::Vector3d(arm.x(), 0, arm.z()) +
        Eigen::Vector3d(0, 1e4 * 0.5 * volume, 0);
    EXPECT_LT((solution->summary.total_load - expected).norm(), 1e-9 * expected.norm());
    const Eigen::Vector3d moment = MomentOf(mesh, solution->load + solution->reaction);
    EXPECT_LT(moment.norm(), 1e-8 * MomentOf(mesh, solution->load).norm());
  }
}

// A bar that turns about its end: σ = ½ ρ ω² (L² − x²), u = ½ ρ ω² (L² x − x³/3) / E where ν = 0.
TEST(Loads, RotationStretchesABar) {
  const mesh::MappedBox box = Bar(3);
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(box, true);
  AnalysisCase analysis;
  analysis.materials = {{"test", 2000, 1e9, 0, 0}};
  analysis.supports = {Symmetric("u_min"), Symmetric("v_min"), Symmetric("w_min")};
  analysis.rotation = Rotation{{0, 0.1, 0.05}, {0, 0, 100}};
  // Only along x: the parts of the load across cancel over the section but for its own width.
  const auto solution = SolveElasticity(mesh, analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  const double pull = 0.5 * 2000 * 1e4;
  EXPECT_NEAR(solution->summary.total_load.x(), pull * 0.02, 1e-6 * pull * 0.02);
  for (const int v :
       mesh::NodesWhere(box, true, [](const Eigen::Vector3d& p) { return p.x() == 1; })) {
    EXPECT_NEAR(solution->displacement(0, v), pull * 2 / 3 / 1e9, 2e-3 * pull / 1e9);
  }
}

// The same bar turned in space, on planes of symmetry that no axis is square to.
TEST(Supports, SymmetryWorksAlongAnyNormal) {
  const double angle = 0.6;
  for (const bool quadratic : {false, true}) {
    const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(Bar(2, angle), quadratic);
    AnalysisCase analysis;
    analysis.materials = {Steel()};
    analysis.supports = {Symmetric("u_min"), Symmetric("v_min"), Symmetric("w_min")};
    analysis.pressures = {{{0, "u_max"}, -21e6}};
    const auto solution = SolveElasticity(mesh, analysis);
    ASSERT_TRUE(solution.ok()) << solution.status();
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector3d strain(1e-4, -0.3e-4, -0.3e-4);
    for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
      const Eigen::Vector3d own = turn.transpose() * mesh.nodes.col(v);
      const Eigen::Vector3d exact = turn * strain.cwiseProduct(own);
      EXPECT_LT((solution->displacement.col(v) - exact).norm(), 1e-15);
      EXPECT_NEAR(solution->maximum_principal[v], 21e6, 1);
    }
    EXPECT_NEAR(solution->part_safety_factor[0], 250.0 / 21, 1e-5);
    EXPECT_LT(solution->summary.imbalance, 1e-12);
  }
}

// A sector of Lamé's cylinder between two planes at 40°, free of axes on one side.
TEST(Supports, ASectorStandsForTheWholeRing) {
  mesh::MappedBox box;
  box.ticks = {mesh::Ticks(8), mesh::Ticks(5), mesh::Ticks(2)};
  box.place = [](const Eigen::Vector3d& p) {
    const double angle = p.y() * 40 * M_PI / 180;
    return Eigen::Vector3d((1 + p.x()) * std::cos(angle), (1 + p.x()) * std::sin(angle),
                           0.2 * p.z());
  };
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(box, true);
  AnalysisCase analysis;
  analysis.materials = {{"steel", 7800, 200e9, 0.3, 0}};
  analysis.supports = {Symmetric("v_min"), Symmetric("v_max"), Symmetric("w_min"),
                       Symmetric("w_max")};
  analysis.pressures = {{{0, "u_min"}, 1e6}};
  const auto solution = SolveElasticity(mesh, analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  const double widening = 1e6 * 1.3 * (0.4 + 4) / (200e9 * 3);
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    const Eigen::Vector2d at = mesh.nodes.col(v).head<2>();
    if (at.norm() > 1 + 1e-9) continue;
    EXPECT_NEAR(at.normalized().dot(solution->displacement.col(v).head<2>()), widening,
                1e-3 * widening);
  }
}

TEST(Supports, OnlyTheFreeMotionIsNamed) {
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(Bar(1, 0.3), false);
  AnalysisCase analysis;
  analysis.materials = {Steel()};
  // Held along the bar and across it, but not along z.
  analysis.supports = {Symmetric("u_min"), Symmetric("v_min")};
  absl::Status status = SolveElasticity(mesh, analysis).status();
  EXPECT_EQ(DetailOf(status).reason, "RIGID_MOTION");
  EXPECT_NE(status.message().find("part 'body' is free to move along z"), std::string::npos)
      << status;
  // Pinned along one vertical edge, as a door is.
  analysis.supports.clear();
  Support hinge{};
  hinge.nodes = mesh::NodesWhere(Bar(1), false,
                                 [](const Eigen::Vector3d& p) { return p.x() == 0 && p.y() == 0; });
  analysis.supports = {hinge};
  status = SolveElasticity(mesh, analysis).status();
  EXPECT_NE(status.message().find("part 'body' is free to rotate about z"), std::string::npos)
      << status;
}

TEST(LoadCases, ShareOneFactorAndCombine) {
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(Bar(2, 0.4), true);
  auto system = ElasticSystem::Create(mesh, {Steel()}, {{{0, "u_min"}}, Symmetric("v_min")});
  ASSERT_TRUE(system.ok()) << system.status();
  LoadCase pull, warm, both;
  pull.forces = {{{0, "u_max"}, {1e3, 2e3, -5e2}}};
  warm.temperature = mesh.nodes.row(0).transpose() * 40;
  warm.gravity = {0, 0, -10};
  both.forces = pull.forces;
  both.forces[0].force *= 2;
  both.temperature = -3 * warm.temperature;
  both.gravity = -3 * warm.gravity;
  const auto a = system->Solve(pull), b = system->Solve(warm), direct = system->Solve(both);
  ASSERT_TRUE(a.ok() && b.ok() && direct.ok());
  const CombinationTerm terms[] = {{2, &*a}, {-3, &*b}};
  const auto combined = system->Combine(terms);
  ASSERT_TRUE(combined.ok()) << combined.status();
  EXPECT_LT((combined->displacement - direct->displacement).norm(),
            1e-10 * direct->displacement.norm());
  EXPECT_LT((combined->stress - direct->stress).norm(), 1e-9 * direct->stress.norm());
  EXPECT_LT((combined->reaction - direct->reaction).norm(), 1e-9 * direct->reaction.norm());
  EXPECT_NEAR(combined->summary.compliance, direct->summary.compliance,
              1e-9 * direct->summary.compliance);
  EXPECT_LT(combined->summary.imbalance, 1e-10);
  const Stresses at_points = system->PointStress(*combined);
  ASSERT_EQ(at_points.cols(), 4 * mesh.tetrahedra.cols());
  EXPECT_LT((at_points - 2 * system->PointStress(*a) + 3 * system->PointStress(*b)).norm(),
            1e-9 * at_points.norm());
  const CombinationTerm wrong[] = {{2, &*a}, {kNan, &*b}};
  EXPECT_EQ(DetailOf(system->Combine(wrong).status()).field, "terms[1]");
}

TEST(LoadCases, AreTheSameOnAnyNumberOfThreads) {
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(Bar(3), true);
  AnalysisCase analysis;
  analysis.materials = {Steel()};
  analysis.supports = {{{0, "u_min"}}};
  analysis.forces = {{{0, "u_max"}, {0, 0, -1e3}}};
  const auto one = SolveElasticity(mesh, analysis, {.threads = 1});
  const auto three = SolveElasticity(mesh, analysis, {.threads = 3});
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_EQ(one->displacement, three->displacement);
  EXPECT_EQ(one->stress, three->stress);
  EXPECT_EQ(one->summary.compliance, three->summary.compliance);
}

TEST(Warmth, ExpandsFreelyWithoutStress) {
  const mesh::MappedBox box = Bar(2);
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(box, true);
  Material wood{"spruce", 450, 0, 0, 30e6};
  Orthotropy& grain = wood.orthotropy.emplace();
  grain.youngs_modulus = {11e9, 0.9e9, 0.5e9};
  grain.poissons_ratio = {0.37, 0.47, 0.42};
  grain.shear_modulus = {0.7e9, 0.04e9, 0.65e9};
  grain.thermal_expansion = {4e-6, 25e-6, 35e-6};
  grain.axes = GrainAxes({1, 0.4, -0.2}, {0, 0.3, 1});
  AnalysisCase analysis;
  analysis.materials = {wood};
  analysis.temperature = Eigen::VectorXd::Constant(mesh.nodes.cols(), 30);
  // Six displacements held: a corner, one along an edge from it, one in a face.
  const auto node = [&](double u, double v, double w) {
    return mesh::NodesWhere(
        box, true, [&](const Eigen::Vector3d& p) { return p == Eigen::Vector3d(u, v, w); });
  };
  Support corner{}, edge{{}, {false, true, true}}, face{{}, {false, false, true}};
  corner.nodes = node(0, 0, 0);
  edge.nodes = node(1, 0, 0);
  face.nodes = node(0, 1, 0);
  analysis.supports = {corner, edge, face};
  const auto solution = SolveElasticity(mesh, analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_LT(solution->von_mises.maxCoeff(), 1e-3);  // beside 11e9 · 35e-6 · 30 = 1e7 if held
  EXPECT_GT(solution->summary.maximum_displacement, 1e-4);
}

TEST(Warmth, PressesABarBetweenWalls) {
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(Bar(2), false);
  AnalysisCase analysis;
  analysis.materials = {Steel()};
  analysis.supports = {Symmetric("u_min"), Symmetric("u_max"), Symmetric("v_min"),
                       Symmetric("w_min")};
  analysis.temperature = Eigen::VectorXd::Constant(mesh.nodes.cols(), 50);
  const auto solution = SolveElasticity(mesh, analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  const double stress = -210e9 * 1.2e-5 * 50;
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    EXPECT_NEAR(solution->stress(0, v), stress, -1e-9 * stress);
    EXPECT_NEAR(solution->von_mises[v], -stress, -1e-9 * stress);
  }
}

TEST(BadLoads, AreNamed) {
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(Bar(1), false);
  auto system = ElasticSystem::Create(mesh, {Steel()}, {{{0, "u_min"}}});
  ASSERT_TRUE(system.ok()) << system.status();
  const auto field = [&](const LoadCase& loads) {
    const absl::Status status = system->Solve(loads).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  LoadCase loads;
  loads.point_forces = {{{5, 0, 0}, {1, 0, 0}}};
  EXPECT_EQ(field(loads), "point_forces[0].position");
  loads.point_forces = {{{0.5, 0.1, 0.05}, {kNan, 0, 0}}};
  EXPECT_EQ(field(loads), "point_forces[0].force");
  loads = {};
  loads.temperature = Eigen::VectorXd::Zero(3);
  EXPECT_EQ(field(loads), "temperature");
  loads = {};
  loads.rotation = Rotation{{0, 0, 0}, {0, kNan, 0}};
  EXPECT_EQ(field(loads), "rotation");
  loads = {};
  loads.tractions = {{{0, "nowhere"}, [](const auto&, const auto& n) { return n; }}};
  EXPECT_EQ(field(loads), "tractions[0].face");
  loads.tractions = {{{0, "u_max"}, {}}};
  EXPECT_EQ(field(loads), "tractions[0].traction");
  loads.tractions = {{{0, "u_max"}, [](const Eigen::Vector3d&, const Eigen::Vector3d&) {
                        return Eigen::Vector3d(kNan, 0, 0);
                      }}};
  EXPECT_EQ(field(loads), "tractions");
  loads = {};
  loads.body_force = [](const Eigen::Vector3d&) { return Eigen::Vector3d(0, kNan, 0); };
  EXPECT_EQ(field(loads), "body_force");
  Support nobody{};
  EXPECT_EQ(DetailOf(ElasticSystem::Create(mesh, {Steel()}, {nobody}).status()).field,
            "supports[0].face");
  nobody.nodes = {100000};
  EXPECT_EQ(DetailOf(ElasticSystem::Create(mesh, {Steel()}, {nobody}).status()).field,
            "supports[0].nodes");
}

}  // namespace
}  // namespace mortise::simulator
