#include "services/interpolator/mapping/control_points.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "common/base/errors.h"
#include "common/mesh/surface_check.h"
#include "services/interpolator/mapping/surface_map.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

// Points along the edges of a block at shares of its first coordinate that its cells do not have.
mesh::ControlVariables VariablesOf(const BlockShape& shape, int pieces) {
  mesh::ControlVariables variables;
  for (int side = 0; side < 4; ++side) {
    const double across = side % 2, high = side / 2;
    const auto at = [&](double share) { return shape.image({share, across, high}); };
    for (int i = 0; i <= pieces; ++i) {
      const double share = static_cast<double>(i) / pieces;
      variables.points.push_back(
          {std::to_string(side) + " at " + std::to_string(share), at(share)});
      if (i == 0) continue;
      mesh::ControlVariables::Path path;
      path.edge = "edge" + std::to_string(side);
      path.to = static_cast<int>(variables.points.size()) - 1;
      path.from = path.to - 1;
      path.way.resize(3, 5);
      for (int k = 0; k < 5; ++k) path.way.col(k) = at((i - 1 + k / 4.0) / pieces);
      variables.paths.push_back(std::move(path));
    }
  }
  return variables;
}

TEST(ControlPointsTest, LieOnTheSurfaceAndAlongItsEdges) {
  const BlockShape arch = ArchShape(0.2, 1.5, 0.1, 0.05);
  const BlockMesh block = MakeBlockMesh(arch, {.along = 11, .across = 3, .high = 3});
  const mesh::ControlVariables variables = VariablesOf(arch, 4);
  ASSERT_OK_AND_ASSIGN(const MarkedSurface marked,
                       PlaceControlVariables(block.marked.surface, variables));
  ASSERT_OK(CheckMarkedSurface(marked, "source"));
  EXPECT_EQ(marked.points.size(), variables.points.size());
  EXPECT_EQ(marked.paths.size(), variables.paths.size());
  const mesh::SurfaceMesh& given = block.marked.surface;
  EXPECT_EQ(marked.surface.vertices.leftCols(given.vertices.cols()), given.vertices);
  for (std::size_t i = 0; i < marked.points.size(); ++i) {
    const Eigen::Vector3d place = marked.surface.vertices.col(marked.points[i].vertex);
    EXPECT_LT((place - variables.points[i].position).norm(), 0.06 * block.cell_size);
  }
  // The paths keep to the edges of the block: two of three coordinates are at an end.
  for (const ControlPath& path : marked.paths) {
    for (const int vertex : path.vertices) {
      if (vertex >= static_cast<int>(given.vertices.cols())) continue;
      const Eigen::Vector3d at = block.block.col(block.node[static_cast<std::size_t>(vertex)]);
      EXPECT_TRUE(at.y() == 0 || at.y() == 1);
      EXPECT_TRUE(at.z() == 0 || at.z() == 1);
    }
  }
}

TEST(ControlPointsTest, LeadToTheKnownMap) {
  const BlockShape box = BoxShape({0.3, 0.1, 0.05}), arch = ArchShape(0.2, 1.5, 0.1, 0.05);
  const BlockMesh target = MakeBlockMesh(box, {.along = 9, .across = 3, .high = 3});
  const BlockMesh source =
      MakeBlockMesh(arch, {.along = 11, .across = 4, .high = 2, .is_mirrored = true});
  ASSERT_OK_AND_ASSIGN(const MarkedSurface ours,
                       PlaceControlVariables(source.marked.surface, VariablesOf(arch, 4)));
  ASSERT_OK_AND_ASSIGN(const MarkedSurface theirs,
                       PlaceControlVariables(target.marked.surface, VariablesOf(box, 4)));
  ASSERT_OK_AND_ASSIGN(const SurfaceMap map, MapSurface(ours, theirs));
  for (std::size_t v = 0; v < target.node.size(); ++v) {
    const Eigen::Vector3d known = arch.image(target.block.col(target.node[v]));
    EXPECT_LT((map.positions.col(static_cast<Eigen::Index>(v)) - known).norm(), source.cell_size);
  }
}

TEST(ControlPointsTest, LeaveOutWhatIsElsewhere) {
  const BlockMesh box = MakeBlockMesh(BoxShape({1, 1, 1}), {});
  mesh::ControlVariables variables = VariablesOf(BoxShape({1, 1, 1}), 2);
  variables.points[1].position << 5, 5, 5;
  variables.points.push_back({"again", variables.points[0].position});
  ASSERT_OK_AND_ASSIGN(const MarkedSurface marked,
                       PlaceControlVariables(box.marked.surface, variables));
  EXPECT_EQ(marked.points.size(), variables.points.size() - 2);
  EXPECT_EQ(marked.paths.size(), variables.paths.size() - 2);
  EXPECT_TRUE(mesh::IsWatertight(marked.surface));
}

TEST(ControlPointsTest, NameWhatIsWrong) {
  const BlockMesh box = MakeBlockMesh(BoxShape({1, 1, 1}), {});
  const mesh::ControlVariables sound = VariablesOf(BoxShape({1, 1, 1}), 2);
  const auto field_of = [](const mesh::SurfaceMesh& surface,
                           const mesh::ControlVariables& variables) {
    const auto marked = PlaceControlVariables(surface, variables);
    EXPECT_EQ(marked.status().code(), absl::StatusCode::kInvalidArgument) << marked.status();
    return DetailOf(marked.status()).field;
  };
  mesh::ControlVariables changed = sound;
  changed.points[2].position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field_of(box.marked.surface, changed), "variables.points[2].position");
  changed = sound;
  changed.paths[1].to = 1000;
  EXPECT_EQ(field_of(box.marked.surface, changed), "variables.paths[1]");
  mesh::SurfaceMesh open = box.marked.surface;
  open.triangles.conservativeResize(3, open.triangles.cols() - 1);
  EXPECT_EQ(field_of(open, sound), "surface");
}

}  // namespace
}  // namespace mortise::interpolator
