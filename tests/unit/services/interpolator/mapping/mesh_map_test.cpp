#include "services/interpolator/mapping/mesh_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

struct Case {
  std::string name;
  BlockShape source, target;
};

std::vector<Case> Cases() {
  return {
      {"box and stretched box", BoxShape({0.3, 0.2, 0.1}), BoxShape({0.2, 0.25, 0.14})},
      {"plate and larger hole", PlateShape(0.3, 0.2, 0.02, 0.08), PlateShape(0.3, 0.2, 0.02, 0.04)},
      {"cylinder and other radius", CylinderShape(0.05, 0.2), CylinderShape(0.08, 0.2)},
      {"bracket and other fillet", BracketShape(0.2, 0.03, 0.05, 0.1),
       BracketShape(0.2, 0.03, 0.02, 0.1)},
  };
}

double VolumeOf(const mesh::TetrahedralMesh& mesh, const Eigen::Matrix3Xd& nodes) {
  double volume = 0;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const Eigen::Vector3d a = nodes.col(mesh.tetrahedra(0, e));
    const Eigen::Vector3d b = nodes.col(mesh.tetrahedra(1, e)) - a;
    const Eigen::Vector3d c = nodes.col(mesh.tetrahedra(2, e)) - a;
    volume += b.cross(c).dot(nodes.col(mesh.tetrahedra(3, e)) - a) / 6;
  }
  return volume;
}

// The mapped mesh has the source's shape in the target's elements: none is turned over, its volume
// is the source's, and every node is near where the solids say that it belongs.
TEST(MeshMapTest, BringsTheShapeIntoTheOtherElements) {
  for (const Case& of : Cases()) {
    const BlockMesh source =
        MakeBlockMesh(of.source, {.along = 8, .across = 7, .high = 5, .unrest = 0.15});
    const BlockMesh target = MakeBlockMesh(
        of.target, {.along = 7, .across = 6, .high = 4, .is_mirrored = true, .unrest = 0.15});
    ASSERT_OK_AND_ASSIGN(const MeshMap map, MapMesh(source.marked_mesh, target.marked_mesh));
    EXPECT_TRUE(map.volume.inverted.empty())
        << of.name << ": " << map.volume.inverted.size() << " of " << map.volume.inverted_at_first
        << " at first, after " << map.volume.solves << " solutions; around "
        << target.block.col(target.marked_mesh.mesh.tetrahedra(
               0, map.volume.inverted.empty() ? 0 : map.volume.inverted.front()));
    const double volume = VolumeOf(target.marked_mesh.mesh, map.nodes);
    const double known = VolumeOf(source.marked_mesh.mesh, source.marked_mesh.mesh.nodes);
    EXPECT_NEAR(volume, known, 0.03 * known) << of.name;
    for (std::size_t v = 0; v < map.outer.node.size(); ++v) {
      EXPECT_EQ(map.nodes.col(map.outer.node[v]),
                map.surface.positions.col(static_cast<Eigen::Index>(v)));
    }
  }
}

TEST(MeshMapTest, KeepsAMeshThatIsMappedToItself) {
  const BlockMesh plate = MakeBlockMesh(PlateShape(0.3, 0.2, 0.02, 0.06), {});
  ASSERT_OK_AND_ASSIGN(const MeshMap map, MapMesh(plate.marked_mesh, plate.marked_mesh));
  EXPECT_LT((map.nodes - plate.marked_mesh.mesh.nodes).cwiseAbs().maxCoeff(), 1e-12);
}

// The vertices and edges of a box by their places, halved where no node need be.
mesh::ControlVariables VariablesOf(const BlockShape& box) {
  mesh::ControlVariables variables;
  std::map<std::string, int> index;
  const auto point = [&](const Eigen::Vector3d& at) {
    const std::string name =
        std::to_string(at.x()) + " " + std::to_string(at.y()) + " " + std::to_string(at.z());
    const auto [entry, is_new] = index.emplace(name, static_cast<int>(variables.points.size()));
    if (is_new) variables.points.push_back({name, box.image(at)});
    return entry->second;
  };
  for (int edge = 0; edge < 12; ++edge) {
    const int axis = edge / 4;
    Eigen::Vector3d start = Eigen::Vector3d::Zero();
    start[(axis + 1) % 3] = edge % 2;
    start[(axis + 2) % 3] = edge / 2 % 2;
    for (const double from : {0.0, 0.5}) {
      mesh::ControlVariables::Path path;
      path.edge = "edge" + std::to_string(edge);
      path.way.resize(3, 2);
      Eigen::Vector3d at = start;
      at[axis] = from;
      path.from = point(at);
      path.way.col(0) = box.image(at);
      at[axis] = from + 0.5;
      path.to = point(at);
      path.way.col(1) = box.image(at);
      variables.paths.push_back(std::move(path));
    }
  }
  return variables;
}

TEST(MeshMapTest, FindsTheControlVariablesOfModels) {
  const BlockShape large = BoxShape({0.3, 0.2, 0.1}), small = BoxShape({0.2, 0.25, 0.14});
  const ModelMesh source{
      MakeBlockMesh(large, {.along = 5, .across = 3, .high = 3}).marked_mesh.mesh,
      VariablesOf(large)};
  const BlockMesh block = MakeBlockMesh(small, {.along = 3, .across = 5, .is_mirrored = true});
  ASSERT_OK_AND_ASSIGN(const MeshMap map,
                       MapMesh(source, {block.marked_mesh.mesh, VariablesOf(small)}));
  EXPECT_EQ(map.surface.points, 8 + 12);
  EXPECT_EQ(map.surface.places.size(), map.outer.node.size());
  EXPECT_TRUE(map.volume.inverted.empty());
  for (std::size_t v = 0; v < map.outer.node.size(); ++v) {
    const int node = map.outer.node[v];
    const Eigen::Vector3d at = block.block.col(node);
    const Eigen::Vector3d image = large.image(at);
    for (int axis = 0; axis < 3; ++axis) {
      // What is on a side of the box stays on it, its edges and corners too.
      if (at[axis] == 0 || at[axis] == 1) {
        EXPECT_NEAR(map.nodes(axis, node), image[axis], 1e-12);
      }
    }
  }
}

TEST(MeshMapTest, SaysWhatDoesNotFit) {
  const MarkedMesh plate = MakeBlockMesh(PlateShape(3, 2, 1, 0.5), {}).marked_mesh;
  const MarkedMesh box = MakeBlockMesh(BoxShape({3, 2, 1}), {}).marked_mesh;
  EXPECT_EQ(DetailOf(MapMesh(plate, box).status()).reason, "TOPOLOGY_DIFFERS");
  MarkedMesh buried = box;
  for (int node = 0; node < static_cast<int>(box.mesh.nodes.cols()); ++node) {
    const Eigen::Vector3d at = box.mesh.nodes.col(node);
    if (at.minCoeff() > 0 && at.x() < 3 && at.y() < 2 && at.z() < 1) buried.points[1].vertex = node;
  }
  EXPECT_EQ(DetailOf(MapMesh(buried, box).status()).field, "source.points[1].vertex");
  EXPECT_EQ(DetailOf(MapMesh(box, buried).status()).field, "target.points[1].vertex");
}

}  // namespace
}  // namespace mortise::interpolator
