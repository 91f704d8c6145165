#include "services/interpolator/mapping/volume_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

// Where the surface of a block goes as the surface of another shape.
Eigen::Matrix3Xd OuterImage(const BlockMesh& block, const BlockImage& image) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(block.node.size()));
  for (std::size_t v = 0; v < block.node.size(); ++v) {
    positions.col(static_cast<Eigen::Index>(v)) = image(block.block.col(block.node[v]));
  }
  return positions;
}

// Of one surface alone.
absl::StatusOr<VolumeMap> Mapped(const mesh::TetrahedralMesh& mesh, const std::vector<int>& outer,
                                 const Eigen::Matrix3Xd& positions) {
  const auto mapper = VolumeMapper::Create(mesh, outer);
  return mapper.ok() ? (*mapper)->Map(positions) : mapper.status();
}

// An affine motion of the surface is one of the whole body: linear elements have it exactly.
TEST(VolumeMapTest, FollowsAffineMotionsExactly) {
  const BlockMesh box = MakeBlockMesh(BoxShape({0.3, 0.2, 0.1}), {.unrest = 0.3});
  Eigen::Matrix3d linear;
  linear << 1.4, 0.2, 0, -0.1, 0.9, 0.3, 0, 0.2, 1.1;
  const Eigen::Vector3d shift(1, 2, 3);
  const auto affine = [&](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    return linear * BoxShape({0.3, 0.2, 0.1}).image(at) + shift;
  };
  ASSERT_OK_AND_ASSIGN(const VolumeMap map,
                       Mapped(box.marked_mesh.mesh, box.node, OuterImage(box, affine)));
  const Eigen::Matrix3Xd expected = (linear * box.marked_mesh.mesh.nodes).colwise() + shift;
  EXPECT_LT((map.nodes - expected).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(map.solves, 1);
  EXPECT_TRUE(map.inverted.empty());
}

TEST(VolumeMapTest, TurnsNoElementOver) {
  struct Case {
    std::string name;
    BlockShape from, to;
  };
  const std::vector<Case> cases = {
      {"box stretched", BoxShape({0.3, 0.2, 0.1}), BoxShape({0.9, 0.1, 0.1})},
      {"cylinder of other radius", CylinderShape(0.05, 0.2), CylinderShape(0.12, 0.2)},
      {"plate with larger hole", PlateShape(0.3, 0.2, 0.02, 0.03),
       PlateShape(0.3, 0.2, 0.02, 0.08)},
      {"bracket with larger fillet", BracketShape(0.2, 0.03, 0.01, 0.1),
       BracketShape(0.2, 0.03, 0.06, 0.1)},
      {"box bent to an arch", BoxShape({0.3, 0.1, 0.06}), ArchShape(0.2, 2, 0.1, 0.06)},
  };
  for (const Case& of : cases) {
    const BlockMesh block =
        MakeBlockMesh(of.from, {.along = 6, .across = 5, .high = 4, .unrest = 0.2});
    ASSERT_OK_AND_ASSIGN(const VolumeMap map, Mapped(block.marked_mesh.mesh, block.node,
                                                     OuterImage(block, of.to.image)));
    EXPECT_TRUE(map.inverted.empty()) << of.name << ": " << map.inverted.size() << " of "
                                      << block.marked_mesh.mesh.tetrahedra.cols();
    EXPECT_TRUE(InvertedElements(block.marked_mesh.mesh, map.nodes).empty()) << of.name;
  }
}

TEST(VolumeMapTest, KeepsMiddlesOfQuadraticElementsHalfway) {
  const BlockMesh box = MakeBlockMesh(BoxShape({0.3, 0.2, 0.1}), {});
  const mesh::TetrahedralMesh quadratic = mesh::MakeQuadratic(box.marked_mesh.mesh);
  const Eigen::Matrix3Xd positions = OuterImage(box, BoxShape({0.4, 0.2, 0.2}).image);
  ASSERT_OK_AND_ASSIGN(const VolumeMap map, Mapped(quadratic, box.node, positions));
  const Eigen::Vector3d middle = map.nodes.col(quadratic.tetrahedra(4, 0));
  const Eigen::Vector3d ends =
      map.nodes.col(quadratic.tetrahedra(0, 0)) + map.nodes.col(quadratic.tetrahedra(1, 0));
  EXPECT_LT((middle - ends / 2).norm(), 1e-15);
}

// A box with one side pushed far into it and out of the other one: no body has this surface.
TEST(VolumeMapTest, TellsWhichElementsAreStillTurnedOver) {
  const BlockMesh box = MakeBlockMesh(BoxShape({1, 1, 1}), {});
  const auto crossed = [](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    return {at.x() == 1 ? -1 : at.x(), at.y(), at.z()};
  };
  ASSERT_OK_AND_ASSIGN(const VolumeMap map,
                       Mapped(box.marked_mesh.mesh, box.node, OuterImage(box, crossed)));
  EXPECT_FALSE(map.inverted.empty());
  EXPECT_EQ(map.inverted, InvertedElements(box.marked_mesh.mesh, map.nodes));
}

TEST(VolumeMapTest, NamesWhatIsWrong) {
  const BlockMesh box = MakeBlockMesh(BoxShape({1, 1, 1}), {});
  const Eigen::Matrix3Xd same = OuterImage(box, BoxShape({1, 1, 1}).image);
  const auto field_of = [](const absl::StatusOr<VolumeMap>& map) {
    EXPECT_EQ(map.status().code(), absl::StatusCode::kInvalidArgument) << map.status();
    return DetailOf(map.status()).field;
  };
  const mesh::TetrahedralMesh& mesh = box.marked_mesh.mesh;
  EXPECT_EQ(field_of(Mapped(mesh, box.node, same.leftCols(3))), "positions");
  std::vector<int> missing = box.node;
  missing.back() = missing.front();
  EXPECT_EQ(field_of(Mapped(mesh, missing, same)), "outer");
  std::vector<int> beyond = box.node;
  beyond[2] = 1000000;
  EXPECT_EQ(field_of(Mapped(mesh, beyond, same)), "outer[2]");
  mesh::TetrahedralMesh inverted = mesh;
  inverted.nodes.row(2) *= -1;
  EXPECT_EQ(field_of(Mapped(inverted, box.node, same)), "mesh");
}

}  // namespace
}  // namespace mortise::interpolator
