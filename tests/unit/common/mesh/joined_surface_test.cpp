#include "common/mesh/joined_surface.h"

#include <gtest/gtest.h>

#include "tests/unit/common/mesh/box_assembly.h"

namespace mortise::mesh {
namespace {

TEST(JoinedSurface, HasOneSurfaceAfterTheOther) {
  const SurfaceMesh a = BoxSurface({0, 0, 0}, {1, 1, 1}), b = BoxSurface({1, 0, 0}, {2, 1, 1});
  const SurfaceMesh both = Joined({a, b});
  ASSERT_EQ(both.vertices.cols(), a.vertices.cols() + b.vertices.cols());
  EXPECT_EQ(both.vertices.leftCols(a.vertices.cols()), a.vertices);
  EXPECT_EQ(both.vertices.rightCols(b.vertices.cols()), b.vertices) << "what they share is twice";
  EXPECT_EQ(both.triangles.leftCols(a.triangles.cols()), a.triangles);
  const Eigen::Matrix3Xi moved = b.triangles.array() + static_cast<int>(a.vertices.cols());
  EXPECT_EQ(both.triangles.rightCols(b.triangles.cols()), moved);
}

TEST(JoinedSurface, IsEmptyOfNone) {
  const SurfaceMesh none = Joined(std::vector<SurfaceMesh>());
  EXPECT_EQ(none.vertices.cols(), 0);
  EXPECT_EQ(none.triangles.cols(), 0);
}

}  // namespace
}  // namespace mortise::mesh
