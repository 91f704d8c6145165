#include "services/interpolator/mapping/sheet_separation.h"

#include <gtest/gtest.h>

#include "common/mesh/halfedge_mesh.h"
#include "tests/support/status_assertions.h"

namespace mortise::interpolator {
namespace {

struct Cubes {
  Eigen::Matrix3Xd vertices;
  Eigen::Matrix3Xi triangles;
};

// Unit cubes from these corners of a grid, with the grid's vertices in common.
Cubes CubesAt(const std::vector<Eigen::Vector3i>& places) {
  Cubes cubes;
  cubes.vertices.resize(3, 64);
  for (int v = 0; v < 64; ++v) cubes.vertices.col(v) << v % 4, v / 4 % 4, v / 16;
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const Eigen::Vector3i& place : places) {
    for (const auto& quad : quads) {
      int at[4];
      for (int k = 0; k < 4; ++k) {
        at[k] = place.x() + quad[k] % 2 + 4 * (place.y() + quad[k] / 2 % 2) +
                16 * (place.z() + quad[k] / 4);
      }
      cubes.triangles.conservativeResize(3, cubes.triangles.cols() + 2);
      cubes.triangles.rightCols(2) << at[0], at[0], at[1], at[2], at[2], at[3];
    }
  }
  return cubes;
}

// Returns the number of vertices that were copied; what is left can be walked on.
std::size_t Copies(const std::vector<Eigen::Vector3i>& places) {
  Cubes cubes = CubesAt(places);
  const std::vector<int> copies = SeparateSheets(cubes.vertices, cubes.triangles);
  mesh::SurfaceMesh surface{cubes.vertices, cubes.triangles};
  surface.vertices.conservativeResize(Eigen::NoChange,
                                      64 + static_cast<Eigen::Index>(copies.size()));
  for (std::size_t i = 0; i < copies.size(); ++i) {
    surface.vertices.col(64 + static_cast<Eigen::Index>(i)) = cubes.vertices.col(copies[i]);
  }
  EXPECT_OK(mesh::ToHalfedgeMesh(surface));
  return copies.size();
}

TEST(SheetSeparationTest, LeavesWhatIsOneSheet) { EXPECT_EQ(Copies({{0, 0, 0}}), 0U); }

TEST(SheetSeparationTest, TakesCubesApartThatMeetInAVertex) {
  EXPECT_EQ(Copies({{0, 0, 0}, {1, 1, 1}}), 1U);
}

TEST(SheetSeparationTest, TakesCubesApartThatMeetInAnEdge) {
  EXPECT_EQ(Copies({{0, 0, 0}, {1, 1, 0}}), 2U);
  EXPECT_EQ(Copies({{1, 0, 0}, {0, 1, 0}}), 2U);
  EXPECT_EQ(Copies({{0, 0, 0}, {1, 0, 1}, {2, 0, 0}}), 4U);
}

}  // namespace
}  // namespace mortise::interpolator
