#include "services/interpolator/shapes/nearest_surface.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

TEST(NearestSurface, FindsTheNearestPointOfABox) {
  const BlockMesh block = MakeBlockMesh(BoxShape({2, 1, 0.5}), {.along = 5, .unrest = 0.2});
  const mesh::SurfaceMesh& surface = block.marked.surface;
  const NearestSurface nearest(surface.vertices, surface.triangles);
  const Eigen::Vector3d size(2, 1, 0.5);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 2);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d point =
        size.cwiseProduct(Eigen::Vector3d(unit(random), unit(random), unit(random)));
    const Eigen::Vector3d inside = point.cwiseMax(0).cwiseMin(size);
    const double to_side =
        inside.array().min((size - inside).array()).minCoeff();  // within: to the nearest face
    const double expected = inside == point ? to_side : (point - inside).norm();
    const SurfacePoint found = nearest.Find(point);
    EXPECT_NEAR(found.distance, expected, 1e-12);
    EXPECT_GE(found.place.barycentric.minCoeff(), 0);
    EXPECT_NEAR(found.place.barycentric.sum(), 1, 1e-12);
    const Eigen::Matrix3d corners =
        surface.vertices(Eigen::all, surface.triangles.col(found.place.triangle));
    EXPECT_NEAR((corners * found.place.barycentric - point).norm(), found.distance, 1e-12);
  }
}

TEST(NearestSurface, LeavesOutTrianglesWithoutArea) {
  Eigen::Matrix3Xd nodes(3, 4);
  nodes << 0, 1, 0, 2, 0, 0, 1, 0, 0, 0, 0, 0;
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 0, 1, 1, 3, 2;
  const NearestSurface nearest(nodes, triangles);
  const SurfacePoint found = nearest.Find({0.2, 0.2, 3});
  EXPECT_EQ(found.place.triangle, 1);
  EXPECT_NEAR(found.distance, 3, 1e-12);
  EXPECT_NEAR(NearestSurface(nodes, triangles.leftCols(1)).Find({0, 0, 2}).distance, 2, 1e-12);
}

}  // namespace
}  // namespace mortise::interpolator
