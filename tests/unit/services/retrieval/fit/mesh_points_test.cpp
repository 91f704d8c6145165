#include "services/retrieval/fit/mesh_points.h"

#include <gtest/gtest.h>

#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

TEST(MeshPointsTest, HasPointsOfEveryTriangle) {
  const mesh::SurfaceMesh board = Box({0, 0, 0}, {1, 1, 0.01});
  const MeshPoints points = SampleSurface(board, 20);
  ASSERT_GE(points.size(), 20);
  for (int t = 0; t < 12; ++t) EXPECT_GE((points.triangles.array() == t).count(), 1) << t;
}

TEST(MeshPointsTest, MovesWithTheSurface) {
  const mesh::SurfaceMesh small = Box({0, 0, 0}, {1, 1, 1}), large = Box({0, 0, 0}, {2, 2, 2});
  const MeshPoints points = SampleSurface(small, 50);
  EXPECT_TRUE(points.PlacesOn(large).isApprox(2 * points.PlacesOn(small)));
  EXPECT_TRUE(points.NormalsOn(large).isApprox(points.NormalsOn(small)));
  EXPECT_TRUE(points.NormalsOn(small).colwise().norm().isOnes(1e-12));
}

TEST(MeshPointsTest, FindsPlacesOnATriangle) {
  Eigen::Matrix3d corners;
  corners.col(0) << 0, 0, 1;
  corners.col(1) << 2, 0, 1;
  corners.col(2) << 0, 2, 1;
  const Eigen::Vector3d where = BarycentricOf(corners, {0.5, 1, 7});
  EXPECT_TRUE((corners * where).isApprox(Eigen::Vector3d(0.5, 1, 1)));
  const Eigen::Vector3d outside = BarycentricOf(corners, {50, 50, 1});
  EXPECT_NEAR(outside.sum(), 1, 1e-12);
  EXPECT_LT((corners * outside).norm(), 10);
  EXPECT_TRUE(BarycentricOf(Eigen::Matrix3d::Ones(), {0, 0, 0}).allFinite());
}

}  // namespace
}  // namespace mortise::retrieval
