#include "services/retrieval/descriptors/surface_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

using mesh::SurfaceMesh;

const SurfaceMesh& Sheet() {
  static const SurfaceMesh sheet{
      (Eigen::Matrix3Xd(3, 4) << 0, 2, 2, 0, 0, 0, 1, 1, 0, 0, 0, 0).finished(),
      (Eigen::Matrix3Xi(3, 2) << 0, 0, 1, 2, 2, 3).finished()};
  return sheet;
}

TEST(SurfaceSamplesTest, AreSpreadMoreEvenlyThanRandomOnes) {
  const SurfaceSamples samples(Sheet().vertices, Sheet().triangles, 1024, 0);
  const WeightedPoints points = samples.At(Sheet().vertices);
  EXPECT_NEAR(points.weights.sum(), 1, 1e-12);
  // Means of a linear, a quadratic and a wavy function; random points miss them by some 0.02.
  const Eigen::ArrayXd x = points.positions.row(0), y = points.positions.row(1);
  EXPECT_NEAR((x.matrix().dot(points.weights)), 1, 4e-3);
  EXPECT_NEAR(((x * y).matrix().dot(points.weights)), 0.5, 4e-3);
  EXPECT_NEAR((x * 3 + y * 2).sin().matrix().dot(points.weights),
              (std::sin(6) + std::sin(2) - std::sin(8)) / 12, 4e-3);
}

TEST(SurfaceSamplesTest, DependOnTheSeedAndNothingElse) {
  const auto points = [](std::uint64_t seed) {
    return SurfaceSamples(Sheet().vertices, Sheet().triangles, 64, seed).At(Sheet().vertices);
  };
  EXPECT_EQ(points(3).positions, points(3).positions);
  EXPECT_NE(points(3).positions, points(4).positions);
}

TEST(SurfaceSamplesTest, WeighByTheAreaThatTheSurfaceHasNow) {
  // A box whose top and bottom grow: their points weigh more, wherever they were chosen.
  const SurfaceMesh cube = Box({0, 0, 0}, {1, 1, 1}), plate = Box({0, 0, 0}, {10, 10, 1});
  const SurfaceSamples samples(cube.vertices, cube.triangles, 600, 0);
  const WeightedPoints points = samples.At(plate.vertices);
  double flat = 0;
  for (Eigen::Index i = 0; i < samples.size(); ++i) {
    const double z = points.positions(2, i);
    if (std::abs(z) < 1e-12 || std::abs(z - 1) < 1e-12) flat += points.weights[i];
  }
  EXPECT_NEAR(flat, 200.0 / 240, 0.01);
}

TEST(SurfaceSamplesTest, DerivativesAgreeWithDifferences) {
  const SurfaceMesh chair = Chair();
  const SurfaceSamples samples(chair.vertices, chair.triangles, 500, 0);
  const Eigen::Matrix3Xd velocities = chair.vertices.array().sin().matrix();
  const PointVelocities moving = samples.Differentiate(chair.vertices, velocities);
  const double step = 1e-5;
  const WeightedPoints above = samples.At(chair.vertices + step * velocities);
  const WeightedPoints below = samples.At(chair.vertices - step * velocities);
  EXPECT_TRUE(moving.positions.isApprox((above.positions - below.positions) / (2 * step), 1e-8));
  EXPECT_TRUE(moving.weights.isApprox((above.weights - below.weights) / (2 * step), 1e-6));
  EXPECT_NEAR(moving.weights.sum(), 0, 1e-12);
}

}  // namespace
}  // namespace mortise::retrieval
