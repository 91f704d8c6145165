// Which edges of a surface are drawn.
#include "common/render/feature_edges.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/common/mesh/box_assembly.h"

namespace mortise::render {
namespace {

bool NoneFacesEye(const Eigen::Vector3d&, const Eigen::Vector3d&) { return false; }

std::size_t CountFeatures(const mesh::SurfaceMesh& surface, double angle) {
  return FindFeatureEdges(surface.vertices, surface.triangles, angle, NoneFacesEye).size();
}

mesh::SurfaceMesh Cube() { return mesh::BoxSurface({0, 0, 0}, {1, 1, 1}); }

TEST(FeatureEdges, AreThoseOfABoxAndNotItsDiagonals) {
  EXPECT_EQ(CountFeatures(Cube(), 0.5), 12u);
  EXPECT_EQ(CountFeatures(Cube(), 1.6), 0u) << "more than a right angle";
  EXPECT_EQ(CountFeatures(Cube(), -1), 18u) << "diagonals, too";
  for (const FeatureEdge& edge :
       FindFeatureEdges(Cube().vertices, Cube().triangles, 0.5, NoneFacesEye)) {
    EXPECT_EQ((edge.end - edge.start).norm(), 1);
  }
}

TEST(FeatureEdges, JoinFacesThatAreMadeOneByOne) {
  const mesh::SurfaceMesh cube = Cube();
  mesh::SurfaceMesh loose = cube;
  loose.vertices = cube.vertices(Eigen::all, cube.triangles.reshaped()).eval();
  for (int i = 0; i < static_cast<int>(loose.triangles.size()); ++i) loose.triangles(i) = i;
  EXPECT_EQ(CountFeatures(loose, 0.5), 12u);
}

TEST(FeatureEdges, AreBordersAndWhereMoreThanTwoTrianglesMeetToo) {
  mesh::SurfaceMesh open = Cube();
  open.triangles.conservativeResize(3, 11);
  EXPECT_EQ(CountFeatures(open, 1.6), 3u);
  mesh::SurfaceMesh fin = Cube();
  fin.triangles.conservativeResize(3, 13);
  fin.vertices.conservativeResize(3, 9);
  fin.vertices.col(8) = Eigen::Vector3d(-1, -2, 0.5);
  fin.triangles.rightCols(1) << fin.triangles(0, 0), fin.triangles(1, 0), 8;
  EXPECT_EQ(CountFeatures(fin, 1.6), 3u) << "two borders of the fin, and its root";
}

TEST(FeatureEdges, AreTheOutlineWhereOneSideFacesTheEye) {
  const auto edges = FindFeatureEdges(
      Cube().vertices, Cube().triangles, 1.6,
      [](const Eigen::Vector3d&, const Eigen::Vector3d& normal) { return normal.z() > 0.5; });
  ASSERT_EQ(edges.size(), 4u);
  for (const FeatureEdge& edge : edges) EXPECT_EQ(edge.start.z() + edge.end.z(), 2);
}

TEST(FeatureEdges, DoNotMindTrianglesWithoutArea) {
  mesh::SurfaceMesh cube = Cube();
  cube.triangles.conservativeResize(3, 13);
  cube.triangles.rightCols(1) << 3, 3, 3;
  EXPECT_EQ(CountFeatures(cube, 0.5), 12u);
}

}  // namespace
}  // namespace mortise::render
