// Derivatives by the nodes' positions, held against central differences on the mesh moved along.
#include "common/fem/elements/shape_derivative.h"

#include <gtest/gtest.h>

#include <random>

#include "common/fem/elements/loads.h"
#include "common/fem/elements/mesh_velocity.h"
#include "common/fem/elements/stiffness.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {
namespace {

constexpr double kStep = 1e-6;

Eigen::Matrix3Xd RandomField(const mesh::TetrahedralMesh& mesh, unsigned seed) {
  std::mt19937 bits(seed);
  std::uniform_real_distribution<double> spread(-1, 1);
  Eigen::Matrix3Xd field(3, mesh.nodes.cols());
  for (double& value : field.reshaped()) value = spread(bits);
  return field;
}

double Dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a.array() * b.array()).sum();
}

mesh::TetrahedralMesh Moved(const mesh::TetrahedralMesh& mesh, const Eigen::Matrix3Xd& velocity,
                            double time) {
  mesh::TetrahedralMesh moved = mesh;
  moved.nodes += time * velocity;
  return moved;
}

// The central difference of a number that is computed on the mesh.
template <typename ValueOf>
double Difference(const mesh::TetrahedralMesh& mesh, const Eigen::Matrix3Xd& velocity,
                  const ValueOf& value_of) {
  return (value_of(Moved(mesh, velocity, kStep)) - value_of(Moved(mesh, velocity, -kStep))) /
         (2 * kStep);
}

Material Wood() {
  Material wood = Steel();
  wood.orthotropy = Orthotropy{.youngs_modulus = {11e9, 0.9e9, 0.5e9},
                               .poissons_ratio = {0.4, 0.5, 0.45},
                               .shear_modulus = {0.7e9, 0.05e9, 0.6e9},
                               .axes = GrainAxes({1, 0.4, 0.2}, {0, 0, 1})};
  return wood;
}

// Boxes of both kinds of elements, whose edges are bent if they have middles.
class ShapeDerivative : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    mesh_ = BoxMesh({0.4, 0.3, 0.2}, {4, 3, 3}, GetParam());
    mesh_.nodes += 0.002 * RandomField(mesh_, 3);
  }
  mesh::TetrahedralMesh mesh_;
};

TEST_P(ShapeDerivative, OfTheStiffnessIsThatOfDifferences) {
  const Eigen::Matrix3Xd u = RandomField(mesh_, 1), adjoint = RandomField(mesh_, 2);
  for (const Material& material : {Steel(), Wood()}) {
    for (unsigned seed = 10; seed < 13; ++seed) {
      const Eigen::Matrix3Xd velocity = RandomField(mesh_, seed);
      const double exact = Dot(StiffnessDerivative(mesh_, {material}, u, adjoint), velocity);
      const double difference = Difference(mesh_, velocity, [&](const mesh::TetrahedralMesh& mesh) {
        const auto stiffness = AssembleStiffness(mesh, {material});
        EXPECT_TRUE(stiffness.ok()) << stiffness.status();
        return Dot(adjoint, stiffness->Multiply(u));
      });
      EXPECT_NEAR(exact, difference, 1e-6 * std::abs(difference));
    }
  }
}

TEST_P(ShapeDerivative, OfLoadsIsThatOfDifferences) {
  const mesh::NamedFace end{0, mesh_.faces[0].origins[0].name};
  const mesh::NamedFace side{0, mesh_.faces[3].origins[0].name};
  const Eigen::Matrix3Xd adjoint = RandomField(mesh_, 2);
  for (int kind = 0; kind < 3; ++kind) {
    LoadCase loads;
    if (kind == 0) loads.forces = {{end, {3, -2, 5}}, {side, {1, 1, -4}}};
    if (kind == 1) loads.pressures = {{side, 7}};
    if (kind == 2) loads.gravity = {1, 2, -9.8};
    for (unsigned seed = 10; seed < 13; ++seed) {
      const Eigen::Matrix3Xd velocity = RandomField(mesh_, seed);
      const double exact = Dot(LoadDerivative(mesh_, {Steel()}, loads, adjoint), velocity);
      const double difference = Difference(mesh_, velocity, [&](const mesh::TetrahedralMesh& mesh) {
        const auto load = AssembleLoads(mesh, {Steel()}, loads);
        EXPECT_TRUE(load.ok()) << load.status();
        return Dot(adjoint, *load);
      });
      EXPECT_NEAR(exact, difference, 1e-6 * std::abs(difference)) << kind;
    }
  }
}

TEST_P(ShapeDerivative, OfMeansAndMassIsThatOfDifferences) {
  const std::vector<int> triangles = TrianglesOn(mesh_, mesh_.faces[1].origins[0], false);
  const Eigen::Matrix3Xd field = RandomField(mesh_, 1), change = RandomField(mesh_, 4);
  const Eigen::Vector3d direction(1, -2, 3);
  const Eigen::Matrix3Xd velocity = RandomField(mesh_, 12);
  const FaceMean mean = MeanOverTriangles(mesh_, triangles, field, direction);
  const double difference = Difference(mesh_, velocity, [&](const mesh::TetrahedralMesh& mesh) {
    return MeanOverTriangles(mesh, triangles, field, direction).value;
  });
  EXPECT_NEAR(Dot(mean.by_position, velocity), difference, 1e-6 * std::abs(difference));
  const double more =
      MeanOverTriangles(mesh_, triangles, field + change, direction).value - mean.value;
  EXPECT_NEAR(Dot(mean.by_field, change), more, 1e-9 * std::abs(more));
  const double mass = Difference(mesh_, velocity, [](const mesh::TetrahedralMesh& mesh) {
    LoadCase loads;
    loads.gravity = {0, 0, 1};
    return AssembleLoads(mesh, {Steel()}, loads)->sum();
  });
  EXPECT_NEAR(Dot(MassDerivative(mesh_, {Steel().density}), velocity), mass, 1e-6 * std::abs(mass));
}

INSTANTIATE_TEST_SUITE_P(Elements, ShapeDerivative, ::testing::Values(false, true),
                         [](const auto& of) { return of.param ? "Quadratic" : "Linear"; });

// A box that grows longer, and shears nowhere.
TEST(MeshVelocity, FollowsTheFaces) {
  const mesh::TetrahedralMesh mesh = BoxMesh({0.4, 0.3, 0.2}, {4, 3, 3}, false);
  std::vector<FaceMotion> motions;
  for (const mesh::AssemblyFace& face : mesh.faces) {
    FaceMotion& motion = motions.emplace_back();
    motion.face = face.origins[0];
    motion.start_velocity = motion.end_velocity = Eigen::Matrix3Xd::Zero(3, 2);
    const std::vector<int> triangles = TrianglesOn(mesh, motion.face, false);
    Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(triangles.size()));
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      positions.col(static_cast<Eigen::Index>(t)) =
          mesh.nodes.col(mesh.face_triangles(0, triangles[t]));
    }
    const Eigen::Vector3d extent = positions.rowwise().maxCoeff() - positions.rowwise().minCoeff();
    Eigen::Index across = 0;
    extent.minCoeff(&across);
    motion.prescribed[static_cast<std::size_t>(across)] = true;
    const bool is_end = across == 0 && positions(0, 0) > 0.2;
    motion.start_velocity(0, 0) = motion.end_velocity(0, 0) = is_end ? 1 : 0;
    const bool is_top = across == 2 && positions(2, 0) > 0.1;
    motion.start_velocity(2, 1) = motion.end_velocity(2, 1) = is_top ? 0.5 : 0;
  }
  const auto velocities = NodeVelocities(mesh, motions, 2, 1e9);
  ASSERT_TRUE(velocities.ok()) << velocities.status();
  for (Eigen::Index node = 0; node < mesh.nodes.cols(); ++node) {
    const Eigen::Vector3d at = mesh.nodes.col(node);
    EXPECT_NEAR(((*velocities)[0].col(node) - Eigen::Vector3d(at[0] / 0.4, 0, 0)).norm(), 0, 1e-9);
    EXPECT_NEAR(((*velocities)[1].col(node) - Eigen::Vector3d(0, 0, 0.5 * at[2] / 0.2)).norm(), 0,
                1e-9);
  }
  motions.pop_back();
  EXPECT_EQ(NodeVelocities(mesh, motions, 2, 1e9).status().code(),
            absl::StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace mortise::simulator
