#include "common/mesh/measures/inside_point.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

// A box between two corners, outward.
SurfaceMesh Box(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  SurfaceMesh box;
  box.vertices.resize(3, 8);
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) box.vertices(k, i) = (i >> k & 1) != 0 ? upper(k) : lower(k);
  }
  box.triangles.resize(3, 12);
  box.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,               //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return box;
}

TEST(InsidePointTest, LiesStrictlyInsideABox) {
  const Eigen::Vector3d lower(1, -2, 3), upper(1.5, 4, 3.01);
  const auto point = InsidePoint(Box(lower, upper));
  ASSERT_TRUE(point.ok()) << point.status();
  for (int k = 0; k < 3; ++k) {
    EXPECT_GT((*point)(k), lower(k));
    EXPECT_LT((*point)(k), upper(k));
  }
}

TEST(InsidePointTest, LiesInTheWallsOfAHollowBox) {
  SurfaceMesh hollow = Box({0, 0, 0}, {1, 1, 1});
  const SurfaceMesh cavity = Box({0.1, 0.1, 0.1}, {0.9, 0.9, 0.9});
  SurfaceMesh both;
  both.vertices.resize(3, 16);
  both.vertices << hollow.vertices, cavity.vertices;
  both.triangles.resize(3, 24);
  both.triangles << hollow.triangles, (cavity.triangles.array() + 8).matrix();
  both.triangles.rightCols(12).row(1).swap(both.triangles.rightCols(12).row(2));
  const auto point = InsidePoint(both);
  ASSERT_TRUE(point.ok()) << point.status();
  EXPECT_TRUE((point->array() > 0).all() && (point->array() < 1).all());
  EXPECT_FALSE((point->array() > 0.1).all() && (point->array() < 0.9).all());
}

TEST(InsidePointTest, FindsNothingInsideOfNothing) {
  EXPECT_EQ(DetailOf(InsidePoint(SurfaceMesh()).status()).field, "surface");
  SurfaceMesh flat;
  flat.vertices.resize(3, 3);
  flat.vertices << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  flat.triangles.resize(3, 2);
  flat.triangles << 0, 0, 1, 2, 2, 1;
  EXPECT_FALSE(InsidePoint(flat).ok());
}

}  // namespace
}  // namespace mortise::mesh
