#include "services/interpolator/mapping/shortest_paths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

// Returns the vertex nearest to a place.
int VertexAt(const mesh::SurfaceMesh& surface, const Eigen::Vector3d& place) {
  Eigen::Index vertex = 0;
  (surface.vertices.colwise() - place).colwise().norm().minCoeff(&vertex);
  return static_cast<int>(vertex);
}

double InsertedLength(LayoutSurface& surface, Corner from, Corner to) {
  const auto path = surface.Insert(ShortestPaths(surface, from, kEverywhere).PathTo(to));
  EXPECT_OK(path);
  return path.ok() ? surface.LengthOf(*path) : 0;
}

// The shortest way over a box from corner to corner is known: straight over the unfolded faces.
TEST(ShortestPathsTest, AreStraightOnTheUnfoldedSurface) {
  const Eigen::Vector3d size(0.3, 0.2, 0.1);
  for (const double unrest : {0.0, 0.25}) {
    const BlockMesh box =
        MakeBlockMesh(BoxShape(size), {.along = 12, .across = 9, .high = 5, .unrest = unrest});
    const mesh::SurfaceMesh& mesh = box.marked.surface;
    const int low = VertexAt(mesh, {0, 0, 0}), high = VertexAt(mesh, size);
    const int beside = VertexAt(mesh, {size.x(), size.y(), 0});
    ASSERT_OK_AND_ASSIGN(LayoutSurface surface, LayoutSurface::Create(mesh, {low, high, beside}));
    surface.LabelPatches();
    const auto lone = [](int node) { return CornerOfLoneNode(node); };
    const ShortestPaths paths(surface, lone(0), kEverywhere);
    ASSERT_EQ(paths.lengths().size(), 2U);
    const double within = std::hypot(size.x(), size.y());
    const double over_two = std::hypot(size.x(), size.y() + size.z());
    EXPECT_GE(paths.lengths().at(lone(2)), within * (1 - 1e-12));
    EXPECT_LT(paths.lengths().at(lone(2)), 1.05 * within);
    // Both shortest ways to the far corner have the same length in unfolded faces of which one is
    // shorter; pulled taut, the path is as long but for what it keeps away from vertices.
    const double taut = InsertedLength(surface, lone(0), lone(1));
    EXPECT_GE(taut, over_two * (1 - 1e-12));
    EXPECT_LT(taut, 1.03 * over_two);
  }
}

TEST(ShortestPathsTest, CrossNoOtherPathAndReachEveryCorner) {
  const BlockMesh box = MakeBlockMesh(BoxShape({1, 1, 1}), {.along = 3, .across = 3, .high = 3});
  const mesh::SurfaceMesh& mesh = box.marked.surface;
  std::vector<int> nodes;
  for (const ControlPoint& point : box.marked.points) nodes.push_back(point.vertex);
  ASSERT_OK_AND_ASSIGN(LayoutSurface surface, LayoutSurface::Create(mesh, nodes));
  for (const ControlPath& path : box.marked.paths) ASSERT_OK(surface.AddPath(path.vertices));
  surface.LabelPatches();
  ASSERT_EQ(surface.patch_count(), 6);
  // From each corner of a face the three others are reached, and nothing of other faces. Paths that
  // are already there leave narrow patches, which paths still cross.
  for (int round = 0; round < 2; ++round) {
    const Corner from = 0;
    const std::vector<int> walk = surface.Walk(from);
    const ShortestPaths paths(surface, from, kEverywhere);
    EXPECT_EQ(paths.lengths().size(), walk.size() - 1);
    for (const auto& [corner, length] : paths.lengths()) {
      EXPECT_EQ(surface.PatchOf(corner), surface.PatchOf(from));
    }
    ASSERT_OK_AND_ASSIGN(const int path, surface.Insert(paths.PathTo(walk[2 - round])));
    ASSERT_GE(surface.SplitPatch(path), 0);
  }
  EXPECT_EQ(surface.patch_count(), 8);
}

}  // namespace
}  // namespace mortise::interpolator
