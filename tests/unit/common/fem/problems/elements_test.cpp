// Elements against fields they must represent: patch tests, orders of convergence, error estimates.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "common/base/errors.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/stress/error_estimate.h"
#include "common/fem/stress/stress_recovery.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "tests/unit/common/fem/problems/exact_solutions.h"

namespace mortise::simulator {
namespace {

// Spruce with its grain out of every axis.
Material Wood() {
  Material wood{"spruce", 450, 0, 0, 30e6};
  Orthotropy& grain = wood.orthotropy.emplace();
  grain.youngs_modulus = {11e9, 0.9e9, 0.5e9};
  grain.poissons_ratio = {0.37, 0.47, 0.42};
  grain.shear_modulus = {0.7e9, 0.04e9, 0.65e9};
  grain.axes = GrainAxes({1, 0.4, -0.2}, {0, 0.3, 1});
  grain.thermal_expansion = {4e-6, 25e-6, 35e-6};
  grain.conductivity = {0.3, 0.15, 0.12};
  return wood;
}

Material Steel() { return {"steel", 7800, 210e9, 0.3, 250e6, 1.2e-5, 50}; }

// A box of uneven elements.
mesh::TetrahedralMesh ShakenBox(bool quadratic) {
  mesh::MappedBox box;
  box.ticks = {mesh::Ticks(4), mesh::Ticks(3, 2), mesh::Ticks(3)};
  box.place = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(p.x(), 0.8 * p.y(), 0.6 * p.z());
  };
  mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(box, false);
  mesh::Shake(mesh, 0.03, 7);
  return quadratic ? mesh::MakeQuadratic(mesh) : mesh;
}

struct PatchCase {
  const char* name;
  bool quadratic;
  bool wood;
};

class PatchTest : public testing::TestWithParam<PatchCase> {};
INSTANTIATE_TEST_SUITE_P(Elements, PatchTest,
                         testing::Values(PatchCase{"LinearIsotropic", false, false},
                                         PatchCase{"LinearOrthotropic", false, true},
                                         PatchCase{"QuadraticIsotropic", true, false},
                                         PatchCase{"QuadraticOrthotropic", true, true}),
                         [](const auto& which) { return which.param.name; });

// Displacements of the outer nodes prescribed from a linear field: the inner ones and the stress
// come out exactly.
TEST_P(PatchTest, ALinearFieldIsExact) {
  const mesh::TetrahedralMesh mesh = ShakenBox(GetParam().quadratic);
  const Material material = GetParam().wood ? Wood() : Steel();
  Eigen::Matrix3d gradient;
  gradient << 1e-3, 2e-4, -3e-4, 5e-4, -7e-4, 1e-4, 2e-4, 6e-4, 4e-4;
  std::vector<bool> outer(mesh.nodes.cols());
  for (Eigen::Index k = 0; k < mesh.face_triangles.size(); ++k) {
    outer[mesh.face_triangles.data()[k]] = true;
  }
  AnalysisCase analysis;
  analysis.materials = {material};
  int inner = 0;
  for (int v = 0; v < mesh.nodes.cols(); ++v) {
    inner += !outer[v];
    if (!outer[v]) continue;
    Support support{{}, {true, true, true}, gradient * mesh.nodes.col(v)};
    support.nodes = {v};
    analysis.supports.push_back(support);
  }
  EXPECT_GT(inner, 5);
  const auto solution = SolveElasticity(mesh, analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  const Eigen::Matrix3Xd exact = gradient * mesh.nodes;
  EXPECT_LT((solution->displacement - exact).cwiseAbs().maxCoeff(),
            1e-13 * exact.cwiseAbs().maxCoeff());
  const Eigen::Matrix3d e = 0.5 * (gradient + gradient.transpose());
  Vector6d strain;
  strain << e(0, 0), e(1, 1), e(2, 2), 2 * e(0, 1), 2 * e(1, 2), 2 * e(0, 2);
  const Vector6d stress = StiffnessMatrix(material) * strain;
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    EXPECT_LT((solution->stress.col(v) - stress).norm(), 1e-11 * stress.norm());
  }
  ThreadTeam alone(1);
  const ErrorEstimate estimate =
      EstimateError(mesh, analysis.materials, solution->displacement, {}, alone);
  EXPECT_LT(estimate.relative, 1e-10);
}

// Pure bending has a quadratic displacement: quadratic elements are exact.
TEST(QuadraticElements, BendExactly) {
  const double curvature = 1e-3;
  mesh::MappedBox box;
  box.ticks = {mesh::Ticks(4), mesh::Ticks(2), mesh::Ticks(2)};
  box.place = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(p.x(), 0.2 * p.y() - 0.1, 0.3 * p.z() - 0.15);
  };
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(box, true);
  const Material steel = Steel();
  const auto exact = [&](const Eigen::Vector3d& x) {
    const double nu = steel.poissons_ratio;
    return Eigen::Vector3d(
        curvature *
        Eigen::Vector3d(x.x() * x.z(), -nu * x.y() * x.z(),
                        -0.5 * x.x() * x.x() + 0.5 * nu * (x.y() * x.y() - x.z() * x.z())));
  };
  AnalysisCase analysis;
  analysis.materials = {steel};
  Support plane{{0, "u_min"}};
  plane.symmetric = true;
  analysis.supports.push_back(plane);
  for (const int v : mesh::NodesWhere(box, true, [](const Eigen::Vector3d& p) {
         return p.x() == 0 && p.z() == 0.5 && (p.y() == 0.5 || p.y() == 0);
       })) {
    Support pin{{}, {false, true, true}, exact(mesh.nodes.col(v))};
    pin.nodes = {v};
    analysis.supports.push_back(pin);
  }
  analysis.tractions = {{{0, "u_max"}, [&](const Eigen::Vector3d& x, const Eigen::Vector3d&) {
                           return Eigen::Vector3d(steel.youngs_modulus * curvature * x.z(), 0, 0);
                         }}};
  const auto solution = SolveElasticity(mesh, analysis);
  ASSERT_TRUE(solution.ok()) << solution.status();
  for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
    const Eigen::Vector3d at = mesh.nodes.col(v);
    EXPECT_LT((solution->displacement.col(v) - exact(at)).norm(), 1e-12 * curvature);
    EXPECT_NEAR(solution->stress(0, v), steel.youngs_modulus * curvature * at.z(),
                1e-8 * steel.youngs_modulus * curvature);
  }
}

// Errors fall as h² and h³ in displacement, and by one order less in energy.
TEST(Convergence, IsOfTheElementsOrder) {
  const BubbleSolution exact;
  for (const bool quadratic : {false, true}) {
    const int coarse = quadratic ? 4 : 8;
    TrueError error[2];
    for (int k = 0; k < 2; ++k) {
      const mesh::TetrahedralMesh mesh = CubeMesh(coarse << k, quadratic);
      const auto solution = SolveElasticity(mesh, exact.Case());
      ASSERT_TRUE(solution.ok()) << solution.status();
      error[k] = MeasureError(mesh, exact, solution->displacement);
    }
    const double order = std::log2(error[0].displacement / error[1].displacement);
    const double energy_order = std::log2(error[0].energy / error[1].energy);
    RecordProperty(quadratic ? "quadratic_order" : "linear_order", std::to_string(order));
    EXPECT_NEAR(order, quadratic ? 3 : 2, 0.2);
    EXPECT_NEAR(energy_order, quadratic ? 2 : 1, 0.2);
  }
}

// The estimate against the true error of a known solution.
TEST(ErrorEstimates, AreNearTheTrueError) {
  const BubbleSolution exact;
  for (const bool quadratic : {false, true}) {
    const mesh::TetrahedralMesh mesh = CubeMesh(8, quadratic);
    const auto solution = SolveElasticity(mesh, exact.Case());
    ASSERT_TRUE(solution.ok()) << solution.status();
    ThreadTeam team(2);
    const ErrorEstimate estimate =
        EstimateError(mesh, {exact.material}, solution->displacement, {}, team);
    const double truth = MeasureError(mesh, exact, solution->displacement).energy;
    EXPECT_NEAR(estimate.error / truth, 1, 0.15) << (quadratic ? "quadratic" : "linear");
    EXPECT_NEAR(estimate.element_error.squaredNorm(), estimate.error * estimate.error,
                1e-12 * estimate.error * estimate.error);
    EXPECT_NEAR(estimate.energy_norm * estimate.energy_norm, 2 * solution->summary.strain_energy,
                0.02 * estimate.energy_norm);
    // Asking for what there is asks for about the same elements; for a quarter, for smaller ones.
    const double same = ElementSizes(mesh, estimate, estimate.relative).mean();
    const double smaller = ElementSizes(mesh, estimate, 0.25 * estimate.relative).mean();
    EXPECT_NEAR(smaller / same, quadratic ? 0.5 : 0.25, 0.06);
  }
}

TEST(Materials, OrthotropyIsTurnedIntoSpace) {
  const Material wood = Wood();
  const Eigen::Matrix3d& axes = wood.orthotropy->axes;
  EXPECT_TRUE(axes.isUnitary(1e-14));
  EXPECT_NEAR(axes.determinant(), 1, 1e-14);
  // Stretched by 1/E₁ along the grain and contracted by ν₁₂/E₁ and ν₁₃/E₁ across, it is pulled
  // along the grain only.
  const Eigen::Vector3d own(1 / 11e9, -0.37 / 11e9, -0.42 / 11e9);
  const Eigen::Matrix3d strain = axes * own.asDiagonal() * axes.transpose();
  Vector6d e;
  e << strain(0, 0), strain(1, 1), strain(2, 2), 2 * strain(0, 1), 2 * strain(1, 2),
      2 * strain(0, 2);
  const Vector6d s = StiffnessMatrix(wood) * e;
  const Eigen::Matrix3d pull = axes.col(0) * axes.col(0).transpose();
  Vector6d expected;
  expected << pull(0, 0), pull(1, 1), pull(2, 2), pull(0, 1), pull(1, 2), pull(0, 2);
  EXPECT_LT((s - expected).norm(), 1e-13);
}

TEST(Materials, EqualDirectionsAreIsotropic) {
  const Material steel = Steel();
  Material same = steel;
  Orthotropy& grain = same.orthotropy.emplace();
  grain.youngs_modulus.setConstant(steel.youngs_modulus);
  grain.poissons_ratio.setConstant(steel.poissons_ratio);
  grain.shear_modulus.setConstant(steel.Mu());
  grain.thermal_expansion.setConstant(steel.thermal_expansion);
  grain.conductivity.setConstant(steel.conductivity);
  grain.axes = GrainAxes({1, 2, 3}, {1, 0, 0});
  EXPECT_LT((StiffnessMatrix(same) - StiffnessMatrix(steel)).norm(),
            1e-12 * StiffnessMatrix(steel).norm());
  EXPECT_LT((ThermalStrain(same) - ThermalStrain(steel)).norm(), 1e-18);
  EXPECT_LT((ConductivityMatrix(same) - ConductivityMatrix(steel)).norm(), 1e-12);
}

TEST(Materials, ImpossibleOnesAreNamed) {
  const auto field = [](const Material& material) {
    return DetailOf(CheckMaterial(material, "materials[0]")).field;
  };
  EXPECT_EQ(CheckMaterial(Wood(), "m"), absl::OkStatus());
  Material wood = Wood();
  wood.orthotropy->poissons_ratio[0] = 4;  // ν₁₂² > E₁/E₂
  EXPECT_EQ(field(wood), "materials[0].orthotropy.poissons_ratio");
  wood = Wood();
  wood.orthotropy->youngs_modulus[1] = 0;
  EXPECT_EQ(field(wood), "materials[0].orthotropy.youngs_modulus");
  wood = Wood();
  wood.orthotropy->shear_modulus[2] = -1;
  EXPECT_EQ(field(wood), "materials[0].orthotropy.shear_modulus");
  wood = Wood();
  wood.orthotropy->axes(0, 0) += 0.01;
  EXPECT_EQ(field(wood), "materials[0].orthotropy.axes");
  wood = Wood();
  wood.orthotropy->axes.col(0) *= -1;
  EXPECT_EQ(field(wood), "materials[0].orthotropy.axes");
  wood = Wood();
  wood.orthotropy->conductivity[1] = 0;
  EXPECT_EQ(DetailOf(CheckConductivity(wood, "materials[0]")).field,
            "materials[0].orthotropy.conductivity");
}

// A turn strains nothing, and the work of a stress is the same of vectors as of tensors.
TEST(Materials, StrainIsTheSymmetricPartOfTheGradient) {
  Eigen::Matrix3d gradient;
  gradient << 1, 2, 3, 5, 7, 11, 13, 17, 19;
  Vector6d stress;
  stress << 23, 29, 31, 37, 41, 43;
  EXPECT_DOUBLE_EQ(stress.dot(StrainOf(gradient)),
                   StressTensor(stress).cwiseProduct(gradient).sum());
  EXPECT_EQ(StrainOf(gradient), StrainOf(gradient.transpose()));
  EXPECT_EQ(StrainOf(gradient - gradient.transpose()), Vector6d::Zero());
}

TEST(Materials, PrincipalStressOfKnownTensors) {
  Vector6d stress;
  stress << 0, 0, 0, 5, 0, 0;  // pure shear
  EXPECT_NEAR(MaximumPrincipal(stress), 5, 1e-12);
  EXPECT_NEAR(VonMises(stress), 5 * std::sqrt(3.0), 1e-12);
  stress << -1, -2, -3, 0, 0, 0;
  EXPECT_NEAR(MaximumPrincipal(stress), -1, 1e-12);
}

}  // namespace
}  // namespace mortise::simulator
