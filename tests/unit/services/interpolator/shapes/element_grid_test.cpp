#include "services/interpolator/shapes/element_grid.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

TEST(ElementGrid, FindsTheElementThatAPointLiesIn) {
  for (const double thickness : {1.0, 1e-3}) {
    const BlockMesh block = MakeBlockMesh(BoxShape({2, 1, thickness}),
                                          {.along = 7, .across = 5, .high = 3, .unrest = 0.3});
    const Eigen::Matrix3Xd& nodes = block.marked_mesh.mesh.nodes;
    const Eigen::Matrix4Xi tetrahedra = block.marked_mesh.mesh.tetrahedra;
    const ElementGrid grid(nodes, tetrahedra);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3d point(2 * unit(random), unit(random), thickness * unit(random));
      const ElementPlace place = grid.Find(point);
      ASSERT_GE(place.element, 0);
      EXPECT_GE(place.barycentric.minCoeff(), 0);
      EXPECT_NEAR(place.barycentric.sum(), 1, 1e-12);
      const Eigen::Matrix<double, 3, 4> corners = nodes(Eigen::all, tetrahedra.col(place.element));
      EXPECT_LT((corners * place.barycentric - point).norm(), 1e-12);
    }
  }
}

TEST(ElementGrid, FindsEveryNodeAndNothingOutside) {
  const BlockMesh block = MakeBlockMesh(ArchShape(1, 2, 0.5, 0.1), {.along = 9, .across = 3});
  const Eigen::Matrix3Xd& nodes = block.marked_mesh.mesh.nodes;
  const Eigen::Matrix4Xi tetrahedra = block.marked_mesh.mesh.tetrahedra;
  const ElementGrid grid(nodes, tetrahedra);
  for (Eigen::Index node = 0; node < nodes.cols(); ++node) {
    EXPECT_GE(grid.Find(nodes.col(node)).element, 0) << node;
  }
  EXPECT_EQ(grid.Find({0, 0.25, 0}).element, -1);    // below the arch
  EXPECT_EQ(grid.Find({0, 0.25, 100}).element, -1);  // beyond its box
  EXPECT_EQ(grid.Find({-1e9, -1e9, 1}).element, -1);
}

TEST(ElementGrid, FindsNothingInFlatElements) {
  Eigen::Matrix3Xd nodes(3, 5);
  nodes << 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 0;
  Eigen::Matrix4Xi tetrahedra(4, 2);
  tetrahedra << 0, 0, 1, 1, 2, 2, 4, 3;  // the first lies in a plane
  const ElementGrid grid(nodes, tetrahedra);
  EXPECT_EQ(grid.Find({0.2, 0.2, 0}).element, 1);
  EXPECT_EQ(grid.Find({0.9, 0.9, 0}).element, -1);
  EXPECT_EQ(ElementGrid(nodes, Eigen::Matrix4Xi(4, 0)).Find({0, 0, 0}).element, -1);
}

}  // namespace
}  // namespace mortise::interpolator
