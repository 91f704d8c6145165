#include "services/interpolator/mapping/mesh_mapper.h"

#include <gtest/gtest.h>

#include <map>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

// A box of a size in some cells, with its corners and edges.
ModelMesh Box(const Eigen::Vector3d& size, const BlockCells& cells) {
  ModelMesh model;
  const BlockMesh block = MakeBlockMesh(BoxShape(size), cells);
  model.mesh = block.marked_mesh.mesh;
  std::map<int, int> point_of;
  for (const ControlPoint& point : block.marked_mesh.points) {
    point_of[point.vertex] = static_cast<int>(model.variables.points.size());
    model.variables.points.push_back({point.name, model.mesh.nodes.col(point.vertex)});
  }
  for (const ControlPath& path : block.marked_mesh.paths) {
    model.variables.paths.push_back({path.name, point_of.at(path.vertices.front()),
                                     point_of.at(path.vertices.back()),
                                     model.mesh.nodes(Eigen::all, path.vertices)});
  }
  return model;
}

TEST(MeshMapperTest, MapsOneSourceAfterAnotherAsEachAlone) {
  const ModelMesh target = Box({0.2, 0.25, 0.14}, {.is_mirrored = true, .unrest = 0.1});
  const ModelMesh tall = Box({0.2, 0.2, 0.3}, {.along = 5}), flat = Box({0.4, 0.2, 0.1}, {});
  ASSERT_OK_AND_ASSIGN(const auto mapper, MeshMapper::Create(target));
  ASSERT_OK_AND_ASSIGN(const MeshMap alone, MapMesh(flat, target));
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

}  // namespace
}  // namespace mortise::interpolator
