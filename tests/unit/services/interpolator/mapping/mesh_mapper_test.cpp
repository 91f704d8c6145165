#include "services/interpolator/mapping/mesh_mapper.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

// A box of a size in some cells, with its corners and edges.
ModelMesh Box(const Eigen::Vector3d& size, const BlockCells& cells) {
  return ModelOf(MakeBlockMesh(BoxShape(size), cells));
}

TEST(MeshMapperTest, MapsOneSourceAfterAnotherAsEachAlone) {
  const ModelMesh target = Box({0.2, 0.25, 0.14}, {.is_mirrored = true, .unrest = 0.1});
  const ModelMesh tall = Box({0.2, 0.2, 0.3}, {.along = 5}), flat = Box({0.4, 0.2, 0.1}, {});
  ASSERT_OK_AND_ASSIGN(const auto mapper, MeshMapper::Create(target));
  ASSERT_OK_AND_ASSIGN(const auto other, MeshMapper::Create(target));
  ASSERT_OK_AND_ASSIGN(const MeshMap alone, other->Map(flat));
  for (const ModelMesh* source : {&flat, &tall, &flat}) {
    ASSERT_OK_AND_ASSIGN(const MeshMap map, mapper->Map(*source));
    EXPECT_TRUE(map.volume.inverted.empty());
    if (source == &flat) {
      EXPECT_EQ(map.nodes, alone.nodes);
    }
  }
}

TEST(MeshMapperTest, TellsPlacesBetweenTheNodesOfTheSource) {
  const ModelMesh target = Box({0.2, 0.25, 0.14}, {.is_mirrored = true, .unrest = 0.1});
  const ModelMesh source = Box({0.3, 0.2, 0.1}, {.along = 5});
  ASSERT_OK_AND_ASSIGN(const auto mapper, MeshMapper::Create(target));
  ASSERT_OK_AND_ASSIGN(const MeshMap map, mapper->Map(source));
  ASSERT_EQ(map.places.size(), map.outer.node.size());
  for (std::size_t v = 0; v < map.places.size(); ++v) {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      place += map.places[v].shares[k] * source.mesh.nodes.col(map.places[v].nodes[k]);
    }
    EXPECT_LT((place - map.nodes.col(map.outer.node[v])).norm(), 1e-12);
  }
}

TEST(MeshMapperTest, NamesTheMeshThatIsWrong) {
  ModelMesh box = Box({0.2, 0.25, 0.14}, {});
  ASSERT_OK_AND_ASSIGN(const auto mapper, MeshMapper::Create(box));
  box.variables.points[2].position.x() = std::nan("");
  EXPECT_EQ(DetailOf(MeshMapper::Create(box).status()).field,
            "target.variables.points[2].position");
  EXPECT_EQ(DetailOf(mapper->Map(box).status()).field, "source.variables.points[2].position");
}

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
TEST(MeshMapperTest, BringsTheShapeIntoTheOtherElements) {
  for (const Case& of : Cases()) {
    const BlockMesh source =
        MakeBlockMesh(of.source, {.along = 8, .across = 7, .high = 5, .unrest = 0.15});
    const BlockMesh target = MakeBlockMesh(
        of.target, {.along = 7, .across = 6, .high = 4, .is_mirrored = true, .unrest = 0.15});
    ASSERT_OK_AND_ASSIGN(const auto mapper, MeshMapper::Create(ModelOf(target)));
    ASSERT_OK_AND_ASSIGN(const MeshMap map, mapper->Map(ModelOf(source)));
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

TEST(MeshMapperTest, KeepsAMeshThatIsMappedToItself) {
  const BlockMesh plate = MakeBlockMesh(PlateShape(0.3, 0.2, 0.02, 0.06), {});
  ASSERT_OK_AND_ASSIGN(const auto mapper, MeshMapper::Create(ModelOf(plate)));
  ASSERT_OK_AND_ASSIGN(const MeshMap map, mapper->Map(ModelOf(plate)));
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

TEST(MeshMapperTest, FindsTheControlVariablesOfModels) {
  const BlockShape large = BoxShape({0.3, 0.2, 0.1}), small = BoxShape({0.2, 0.25, 0.14});
  const ModelMesh source{
      MakeBlockMesh(large, {.along = 5, .across = 3, .high = 3}).marked_mesh.mesh,
      VariablesOf(large)};
  const BlockMesh block = MakeBlockMesh(small, {.along = 3, .across = 5, .is_mirrored = true});
  ASSERT_OK_AND_ASSIGN(const auto mapper,
                       MeshMapper::Create({block.marked_mesh.mesh, VariablesOf(small)}));
  ASSERT_OK_AND_ASSIGN(const MeshMap map, mapper->Map(source));
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

TEST(MeshMapperTest, SaysWhatDoesNotFit) {
  const ModelMesh plate = ModelOf(MakeBlockMesh(PlateShape(3, 2, 1, 0.5), {}));
  ASSERT_OK_AND_ASSIGN(const auto mapper, MeshMapper::Create(Box({3, 2, 1}, {})));
  EXPECT_EQ(DetailOf(mapper->Map(plate).status()).reason, "TOPOLOGY_DIFFERS");
}

}  // namespace
}  // namespace mortise::interpolator
