#include "services/interpolator/mapping/nearest_place.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

TEST(NearestPlacesTest, FindsPlacesOnABox) {
  const mesh::SurfaceMesh box = MakeBlockMesh(BoxShape({1, 2, 3}), {}).marked.surface;
  ASSERT_OK_AND_ASSIGN(const NearestPlaces nearest, NearestPlaces::Create(box));
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.4, 1.3, 4), Eigen::Vector3d(-1, 5, 0.7),
                                       Eigen::Vector3d(0.5, 1, 0.1), Eigen::Vector3d(2, 3, 4)}) {
    Eigen::Vector3d known = point.cwiseMax(0).cwiseMin(Eigen::Vector3d(1, 2, 3));
    if (known == point) known.z() = 0;
    ASSERT_OK_AND_ASSIGN(const TrianglePlace place, nearest.Find(point));
    const Eigen::Vector3d found =
        box.vertices(Eigen::all, box.triangles.col(place.triangle)) * place.barycentric;
    EXPECT_LT((found - known).norm(), 1e-12);
    EXPECT_NEAR(nearest.Distance(point).value(), (known - point).norm(), 1e-12);
  }
}

TEST(NearestPlacesTest, FindsTheNearestPointOfManyPlaces) {
  const BlockMesh block = MakeBlockMesh(BoxShape({2, 1, 0.5}), {.along = 5, .unrest = 0.2});
  const mesh::SurfaceMesh& surface = block.marked.surface;
  ASSERT_OK_AND_ASSIGN(const NearestPlaces nearest, NearestPlaces::Create(surface));
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
    ASSERT_OK_AND_ASSIGN(const TrianglePlace found, nearest.Find(point));
    EXPECT_NEAR(nearest.Distance(point).value(), expected, 1e-12);
    EXPECT_GE(found.barycentric.minCoeff(), 0);
    EXPECT_NEAR(found.barycentric.sum(), 1, 1e-12);
    const Eigen::Matrix3d corners =
        surface.vertices(Eigen::all, surface.triangles.col(found.triangle));
    EXPECT_NEAR((corners * found.barycentric - point).norm(), expected, 1e-12);
  }
}

TEST(NearestPlacesTest, LeavesOutTrianglesWithoutArea) {
  Eigen::Matrix3Xd nodes(3, 4);
  nodes << 0, 1, 0, 2, 0, 0, 1, 0, 0, 0, 0, 0;
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 0, 1, 1, 3, 2;
  ASSERT_OK_AND_ASSIGN(const NearestPlaces nearest, NearestPlaces::Create({nodes, triangles}));
  EXPECT_EQ(nearest.Find({0.2, 0.2, 3})->triangle, 1);
  EXPECT_NEAR(nearest.Distance({0.2, 0.2, 3}).value(), 3, 1e-12);
  ASSERT_OK_AND_ASSIGN(const NearestPlaces first,
                       NearestPlaces::Create({nodes, triangles.leftCols(1)}));
  EXPECT_NEAR(first.Distance({0, 0, 2}).value(), 2, 1e-12);
}

}  // namespace
}  // namespace mortise::interpolator
