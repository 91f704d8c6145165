#include "services/interpolator/mapping/untangling.h"

#include <gtest/gtest.h>

#include <random>

#include "services/interpolator/mapping/volume_map.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

TEST(UntanglingTest, TurnsElementsBackAndLeavesTheSurfaceAlone) {
  const BlockMesh box = MakeBlockMesh(BoxShape({6, 6, 6}), {.along = 6, .across = 6, .high = 6});
  const mesh::TetrahedralMesh& mesh = box.marked_mesh.mesh;
  std::vector<bool> is_free(static_cast<std::size_t>(mesh.nodes.cols()), true);
  for (const int node : box.node) is_free[static_cast<std::size_t>(node)] = false;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-0.9, 0.9);
    Eigen::Matrix3Xd nodes = mesh.nodes;
    for (Eigen::Index node = 0; node < nodes.cols(); ++node) {
      if (!is_free[static_cast<std::size_t>(node)]) continue;
      for (int axis = 0; axis < 3; ++axis) nodes(axis, node) += noise(random);
    }
    ASSERT_FALSE(InvertedElements(mesh, nodes).empty());
    Untangle(mesh, is_free, nodes);
    EXPECT_TRUE(InvertedElements(mesh, nodes).empty()) << "seed " << seed;
    for (const int node : box.node) EXPECT_EQ(nodes.col(node), mesh.nodes.col(node));
  }
}

TEST(UntanglingTest, LeavesSoundMeshesAlone) {
  const BlockMesh box = MakeBlockMesh(BoxShape({1, 1, 1}), {});
  Eigen::Matrix3Xd nodes = box.marked_mesh.mesh.nodes;
  Untangle(box.marked_mesh.mesh, std::vector<bool>(static_cast<std::size_t>(nodes.cols()), true),
           nodes);
  EXPECT_EQ(nodes, box.marked_mesh.mesh.nodes);
}

}  // namespace
}  // namespace mortise::interpolator
