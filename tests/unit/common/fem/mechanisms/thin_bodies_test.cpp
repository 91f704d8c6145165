// Sheets and rods down to a 2000th as thick as long: sound structures, however badly conditioned
// their stiffness, solved to what is known of them.
#include "tests/unit/common/fem/mechanisms/thin_bodies.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/errors.h"
#include "common/fem/elements/internal_forces.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/linear/exact_correction.h"
#include "common/fem/problems/modal_analysis.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {
namespace {

class ThinBodies : public testing::TestWithParam<std::tuple<ThinBody, SolverKind>> {
 protected:
  const ThinBody& body() const { return std::get<0>(GetParam()); }
  ElasticityOptions Options() const {
    ElasticityOptions options;
    options.solver.kind = std::get<1>(GetParam());
    return options;
  }
};

INSTANTIATE_TEST_SUITE_P(Bodies, ThinBodies,
                         testing::Combine(testing::ValuesIn(kThinBodies),
                                          testing::Values(SolverKind::kDirect,
                                                          SolverKind::kIterative)),
                         [](const auto& which) {
                           return std::string(std::get<0>(which.param).name) +
                                  (std::get<1>(which.param) == SolverKind::kDirect ? "ByFactor"
                                                                                   : "ByIteration");
                         });

TEST_P(ThinBodies, BendAsTheyMust) {
  const mesh::TetrahedralMesh mesh = MeshOf(body(), true);
  const auto solution = SolveElasticity(mesh, EndMoment(body()), Options());
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_LT(ErrorOfBending(body(), mesh, solution->displacement), 1e-6);
  EXPECT_LT(solution->summary.residual, 1e-5);
  const double stress = 0.5 * kThinModulus * kThinCurvature * body().size.z();
  EXPECT_NEAR(solution->von_mises.maxCoeff(), stress, 1e-4 * stress);
}

// Linear elements are far too stiff in bending, but what they are is determined.
TEST_P(ThinBodies, OfLinearElementsAreSolvedToo) {
  const mesh::TetrahedralMesh mesh = MeshOf(body(), false);
  AnalysisCase analysis;
  analysis.materials = {Steel()};
  analysis.supports = {{{0, "u_min"}}};
  analysis.gravity = {0, 0, -9.81};
  const auto solution = SolveElasticity(mesh, analysis, Options());
  ASSERT_TRUE(solution.ok()) << solution.status();
  // The work of the weight is twice the energy of the strains; both are summed by themselves.
  EXPECT_NEAR(solution->summary.strain_energy, 0.5 * solution->summary.compliance,
              1e-6 * solution->summary.compliance);
  EXPECT_LT(solution->summary.residual, 1e-6);
  EXPECT_LT(solution->summary.imbalance, 1e-6);
}

// What the factor leaves of a rod that is thinner still is corrected, or else iterated; nothing of
// it is free to move.
TEST(ThinRods, BendAsTheyMustHoweverThin) {
  for (const double thickness : {1.0 / 4000, 1e-4}) {
    const ThinBody rod{"rod", {1, thickness, thickness}, {80, 1, 1}};
    const mesh::TetrahedralMesh mesh = MeshOf(rod, true);
    for (const SolverKind kind : {SolverKind::kAutomatic, SolverKind::kDirect}) {
      ElasticityOptions options;
      options.solver.kind = kind;
      const auto solution = SolveElasticity(mesh, EndMoment(rod), options);
      ASSERT_TRUE(solution.ok()) << thickness << solution.status();
      EXPECT_LT(ErrorOfBending(rod, mesh, solution->displacement), 1e-6);
    }
  }
}

TEST(ThinRods, OfManyElementsHangAsBeamsDo) {
  const double thickness = 1.0 / 4000;
  const mesh::TetrahedralMesh mesh = MeshOf({"rod", {1, thickness, thickness}, {2000, 1, 1}}, true);
  AnalysisCase analysis;
  analysis.materials = {Steel()};
  analysis.materials[0].poissons_ratio = 0;
  analysis.supports = {{{0, "u_min"}}};
  analysis.gravity = {0, 0, -9.81};
  const auto solution = SolveElasticity(mesh, analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  const double tip = 1.5 * 7850 * 9.81 / (210e9 * thickness * thickness);
  EXPECT_NEAR(solution->displacement.row(2).minCoeff(), -tip, 1e-3 * tip);
  EXPECT_LT(solution->summary.residual, 1e-5);
}

TEST(ThinSheet, IsSolvedByAFactorWhereAnIterationDoesNotConverge) {
  const ThinBody& sheet = kThinBodies[1];
  const mesh::TetrahedralMesh mesh = MeshOf(sheet, true);
  ElasticityOptions options;
  options.solver.kind = SolverKind::kIterative;
  options.solver.maximum_iterations = 20;
  const auto solution = SolveElasticity(mesh, EndMoment(sheet), options);
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_EQ(solution->summary.solver.kind, SolverKind::kDirect);
  EXPECT_LT(ErrorOfBending(sheet, mesh, solution->displacement), 1e-6);
}

// A rod in space and one that is clamped: six motions without strain, or none, and then the
// frequencies of Euler's beam, each twice.
TEST(ThinModes, OfARodAreThoseOfABeam) {
  const ThinBody rod{"rod", {1, 5e-4, 5e-4}, {60, 1, 1}};
  const mesh::TetrahedralMesh mesh = MeshOf(rod, true);
  Material material = Steel();
  material.poissons_ratio = 0;
  const double unit = rod.size.z() * std::sqrt(210e9 / (12 * 7850.0)) / (2 * M_PI);
  for (const bool is_free : {true, false}) {
    const std::vector<Support> supports =
        is_free ? std::vector<Support>{} : std::vector<Support>{{{0, "u_min"}}};
    const auto modes = FindModes(mesh, {material}, supports, {.count = 4});
    ASSERT_TRUE(modes.ok()) << modes.status();
    ASSERT_EQ(modes->rigid_motions, is_free ? 6 : 0);
    const double roots[] = {is_free ? 4.730041 : 1.875104, is_free ? 7.853205 : 4.694091};
    for (int m = 0; m < 4; ++m) {
      const double expected = roots[m / 2] * roots[m / 2] * unit;
      EXPECT_NEAR(modes->modes[modes->rigid_motions + m].frequency, expected, 1e-3 * expected) << m;
    }
  }
}

// A small system of springs whose rounding is known.
TEST(Correction, RemovesWhatAnInexactSolverLeaves) {
  const int nodes = 40;
  Eigen::ArrayXd stiffness = Eigen::ArrayXd::LinSpaced(3 * nodes, 0, 12).unaryExpr([](double e) {
    return std::pow(10, e);
  });
  const auto times = [](const Eigen::Matrix3Xd& x, const Eigen::ArrayXd& by) {
    Eigen::Matrix3Xd product(3, x.cols());
    product.reshaped() = x.reshaped().array() * by;
    return product;
  };
  const Eigen::Matrix3Xd exact = Eigen::Matrix3Xd::Ones(3, nodes);
  const Eigen::Matrix3Xd load = times(exact, stiffness);
  const Eigen::ArrayXd inexact =
      (1 + 0.3 * Eigen::ArrayXd::LinSpaced(3 * nodes, -1, 1)) / stiffness;
  const CorrectedSystem system{[&](const Eigen::Matrix3Xd& x) { return times(x, stiffness); },
                               [&](const Eigen::Matrix3Xd& b) -> absl::StatusOr<Eigen::Matrix3Xd> {
                                 return times(b, inexact);
                               }};
  Eigen::Matrix3Xd x = times(load, inexact);
  const auto correction = CorrectSolution(system, load, 1e-10, x);
  ASSERT_TRUE(correction.ok()) << correction.status();
  EXPECT_LE(correction->error, 1e-10);
  EXPECT_LT(correction->rounds, 15);
  const double error = (times(x - exact, stiffness.sqrt())).norm();
  EXPECT_LT(error, 1e-9 * times(exact, stiffness.sqrt()).norm());
  const CorrectedSystem negative{[&](const Eigen::Matrix3Xd& b) { return times(b, -stiffness); },
                                 system.solve};
  EXPECT_EQ(DetailOf(CorrectSolution(negative, load, 1e-10, x).status()).reason, "SINGULAR");
}

TEST(InternalForces, AreThoseOfTheStiffnessAndVanishInRigidMotion) {
  for (const bool quadratic : {false, true}) {
    const mesh::TetrahedralMesh mesh = BoxMesh({1, 0.6, 0.4}, {4, 3, 2}, quadratic);
    ThreadTeam alone(1), three(3);
    const auto stiffness = AssembleStiffness(mesh, {Steel()}, {}, alone);
    ASSERT_TRUE(stiffness.ok());
    const Eigen::Matrix3Xd u = Eigen::Matrix3Xd::Random(3, mesh.nodes.cols());
    const Eigen::Matrix3Xd expected = stiffness->Multiply(u);
    const Eigen::Matrix3Xd forces = InternalForces(mesh, {Steel()}, u, alone);
    EXPECT_LT((forces - expected).norm(), 1e-12 * expected.norm());
    EXPECT_EQ(forces, InternalForces(mesh, {Steel()}, u, three));
    const Eigen::Matrix3Xd shift = Eigen::Vector3d(1, 2, 3).replicate(1, mesh.nodes.cols());
    EXPECT_EQ(InternalForces(mesh, {Steel()}, shift, alone).norm(), 0);
  }
}

}  // namespace
}  // namespace mortise::simulator
