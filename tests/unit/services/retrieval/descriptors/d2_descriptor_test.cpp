#include "services/retrieval/descriptors/d2_descriptor.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/round_solids.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

using mesh::SurfaceMesh;

Eigen::VectorXd Vector(const SurfaceMesh& surface, const D2Settings& settings = {}) {
  const auto vector = D2Descriptor(settings).Describe(surface);
  EXPECT_TRUE(testing::IsOk(vector));
  return *vector;
}

TEST(D2DescriptorTest, OfASphereIsThatOfItsKnownDistribution) {
  // Distances on a sphere of radius R have the density d / 2R² up to 2R, of mean 4R/3; in means,
  // 8x/9 up to 3/2.
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(300);
  constexpr int kSteps = 20000;
  for (int step = 0; step < kSteps; ++step) {
    const double x = 1.5 * (step + 0.5) / kSteps;
    for (int k = 0; k < 300; ++k) {
      const double offset = (x - 3.0 * k / 299) / 0.1;
      expected[k] += 8 * x / 9 * std::exp(-offset * offset / 2) * 1.5 / kSteps;
    }
  }
  const Eigen::VectorXd vector = Vector(mesh::Sphere(2.5, 64));
  EXPECT_LT((vector - expected).norm(), 0.01);
  EXPECT_LT((vector - expected).cwiseAbs().maxCoeff(), 0.002);
}

TEST(D2DescriptorTest, IgnoresRotationsAndMirrorImages) {
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_LT((Vector(Chair()) - Vector(mesh::Rotated(Chair(), rotation))).norm(), 0.02);
  SurfaceMesh mirrored = Chair();
  mirrored.vertices.row(0) *= -1;
  EXPECT_LT((Vector(Chair()) - Vector(mirrored)).norm(), 0.02);
}

TEST(D2DescriptorTest, HasLessNoiseThanThreeThousandRandomPoints) {
  // Those differ by some 0.02 to 0.04 from one draw to the next.
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    D2Settings settings;
    settings.seed = seed;
    EXPECT_LT((Vector(Chair()) - Vector(Chair(), settings)).norm(), 0.02);
  }
}

TEST(D2DescriptorTest, DerivativesAreThoseOfTheDescriptor) {
  const SurfaceMesh chair = Chair();
  const auto bound = D2Descriptor().Bind(chair);
  ASSERT_TRUE(testing::IsOk(bound));
  const std::vector<Eigen::Matrix3Xd> velocities = {
      (Chair({1.45, 0.5, 0.42, 0.4}).vertices - chair.vertices),
      chair.vertices.array().sin().matrix()};
  const auto result = (*bound)->Differentiate(chair.vertices, velocities);
  ASSERT_TRUE(testing::IsOk(result));
  EXPECT_EQ(result->value, *(*bound)->Describe(chair.vertices));
  for (Eigen::Index k = 0; k < 2; ++k) {
    const double step = 1e-4;
    const auto& velocity = velocities[static_cast<std::size_t>(k)];
    const Eigen::VectorXd difference = (*(*bound)->Describe(chair.vertices + step * velocity) -
                                        *(*bound)->Describe(chair.vertices - step * velocity)) /
                                       (2 * step);
    EXPECT_LT((result->jacobian.col(k) - difference).norm(), 1e-3 * difference.norm());
  }
}

TEST(D2DescriptorTest, HasNoDerivativeAlongMovesThatItIgnores) {
  const SurfaceMesh chair = Chair();
  const auto bound = D2Descriptor().Bind(chair);
  ASSERT_TRUE(testing::IsOk(bound));
  Eigen::Matrix3Xd spinning = chair.vertices;
  spinning.row(0) = -chair.vertices.row(1);
  spinning.row(1) = chair.vertices.row(0);
  spinning.row(2).setZero();
  const Eigen::Matrix3Xd moving = Eigen::Matrix3Xd::Ones(3, chair.vertices.cols());
  const auto result =
      (*bound)->Differentiate(chair.vertices, std::vector{chair.vertices, spinning, moving});
  ASSERT_TRUE(testing::IsOk(result));
  EXPECT_LT(result->jacobian.norm(), 1e-9);
}

}  // namespace
}  // namespace mortise::retrieval
