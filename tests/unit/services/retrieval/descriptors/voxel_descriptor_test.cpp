#include "services/retrieval/descriptors/voxel_descriptor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

using mesh::SurfaceMesh;

Eigen::VectorXd Vector(const SurfaceMesh& surface) {
  const auto vector = VoxelDescriptor().Describe(surface);
  EXPECT_TRUE(testing::IsOk(vector));
  return *vector;
}

TEST(VoxelDescriptorTest, OfABoxIsThatOfItsFaces) {
  // A kernel over a face is the product of one value and two error functions.
  const Eigen::Vector3d size(2, 3, 6);  // half of its diagonal is 3.5
  const Eigen::Array3d half = size.array() / 7;
  const auto along = [&](int axis, double mean) {  // the mean over the box's side
    const double scale = 0.2 * std::sqrt(2.0);
    return scale * std::sqrt(M_PI) / 2 / (2 * half[axis]) *
           (std::erf((half[axis] - mean) / scale) + std::erf((half[axis] + mean) / scale));
  };
  const auto ends = [&](int axis, double mean) {  // the mean of both ends
    const auto at = [&](double place) { return std::exp(-std::pow((place - mean) / 0.2, 2) / 2); };
    return (at(half[axis]) + at(-half[axis])) / 2;
  };
  const Eigen::Array3d areas(half[1] * half[2], half[0] * half[2], half[0] * half[1]);
  Eigen::VectorXd expected(1000);
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Array3d mean = Eigen::Array3d(k % 10, k / 10 % 10, k / 100) * (2.0 / 9) - 1;
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int second = (axis + 1) % 3, third = (axis + 2) % 3;
      sum += areas[axis] * ends(axis, mean[axis]) * along(second, mean[second]) *
             along(third, mean[third]);
    }
    expected[k] = sum / areas.sum();
  }
  const Eigen::VectorXd vector = Vector(Box({5, 5, 5}, Eigen::Vector3d(5, 5, 5) + size));
  EXPECT_LT((vector - expected).norm(), 0.005 * expected.norm());
}

TEST(VoxelDescriptorTest, TellsAShapeFromItsMirrorImage) {
  // A chair with one arm.
  const SurfaceMesh armchair = Joined({Chair(), Box({0, 0, 0.6}, {0.05, 0.5, 0.65})});
  SurfaceMesh mirrored = armchair;
  mirrored.vertices.row(0) *= -1;
  EXPECT_GT(VoxelDescriptor().Distance(Vector(armchair), Vector(mirrored)), 0.05);
}

TEST(VoxelDescriptorTest, DerivativesAreThoseOfTheDescriptor) {
  const SurfaceMesh chair = Chair();
  const auto bound = VoxelDescriptor().Bind(chair);
  ASSERT_TRUE(testing::IsOk(bound));
  const std::vector<Eigen::Matrix3Xd> velocities = {
      (Chair({1.45, 0.5, 0.42, 0.4}).vertices - chair.vertices),
      (Chair({0.45, 0.5, 0.42, 1.4}).vertices - chair.vertices), chair.vertices,
      Eigen::Matrix3Xd::Ones(3, chair.vertices.cols())};
  const auto result = (*bound)->Differentiate(chair.vertices, velocities);
  ASSERT_TRUE(testing::IsOk(result));
  EXPECT_EQ(result->value, *(*bound)->Describe(chair.vertices));
  for (Eigen::Index k = 0; k < 2; ++k) {
    const double step = 1e-5;
    const auto& velocity = velocities[static_cast<std::size_t>(k)];
    const Eigen::VectorXd difference = (*(*bound)->Describe(chair.vertices + step * velocity) -
                                        *(*bound)->Describe(chair.vertices - step * velocity)) /
                                       (2 * step);
    EXPECT_LT((result->jacobian.col(k) - difference).norm(), 2e-3 * difference.norm());
  }
  // Neither growing nor moving changes it.
  EXPECT_LT(result->jacobian.rightCols(2).norm(), 1e-9);
}

}  // namespace
}  // namespace mortise::retrieval
