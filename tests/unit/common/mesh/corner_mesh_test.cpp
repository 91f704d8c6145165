#include "common/mesh/corner_mesh.h"

#include <gtest/gtest.h>

namespace mortise::mesh {
namespace {

// Two tetrahedra on one triangle, with a node that neither names.
TetrahedralMesh TwoElements() {
  TetrahedralMesh mesh;
  mesh.nodes.resize(3, 6);
  mesh.nodes.transpose() << 9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1;
  mesh.tetrahedra.resize(4, 2);
  mesh.tetrahedra.col(0) << 1, 2, 3, 4;
  mesh.tetrahedra.col(1) << 2, 3, 4, 5;
  mesh.part = Eigen::VectorXi::Zero(2);
  mesh.part_names = {"body"};
  return mesh;
}

TEST(CornerMeshTest, KeepsCornersAndElements) {
  const TetrahedralMesh linear = TwoElements(), quadratic = MakeQuadratic(linear);
  for (const TetrahedralMesh& mesh : {linear, quadratic}) {
    const CornerMesh corners = CornersOf(mesh);
    EXPECT_EQ(corners.mesh.nodes.cols(), 5);
    EXPECT_EQ(corners.corner_of[0], -1);
    ASSERT_EQ(corners.mesh.tetrahedra.cols(), 2);
    for (Eigen::Index e = 0; e < 2; ++e) {
      for (int k = 0; k < 4; ++k) {
        EXPECT_EQ(corners.mesh.nodes.col(corners.mesh.tetrahedra(k, e)),
                  mesh.nodes.col(mesh.tetrahedra(k, e)));
      }
    }
  }
}

// What is linear in space is given back exactly.
TEST(CornerMeshTest, SpreadsValuesOverMiddles) {
  const TetrahedralMesh mesh = MakeQuadratic(TwoElements());
  const CornerMesh corners = CornersOf(mesh);
  Eigen::Matrix3d gradient;
  gradient << 1, 2, 3, 0, -1, 4, 2, 2, 0.5;
  const Eigen::Matrix3Xd values = AtAllNodes(mesh, corners, gradient * corners.mesh.nodes);
  EXPECT_EQ(values.col(0), Eigen::Vector3d::Zero());
  const Eigen::Matrix3Xd expected = gradient * mesh.nodes;
  EXPECT_LT((values - expected).rightCols(mesh.nodes.cols() - 1).cwiseAbs().maxCoeff(), 1e-14);
}

}  // namespace
}  // namespace mortise::mesh
