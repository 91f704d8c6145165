#include "services/interpolator/building/traits.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/unit/services/interpolator/building/formula_blocks.h"

namespace mortise::interpolator {
namespace {

CanonicalMesh BlockMeshOf(int cells) {
  FormulaBlock block = PlainBlock(Eigen::Vector2d(0.5, 0.5));
  block.cells = cells;
  return CanonicalMesh::Create(MakeBlock(block)).value();
}

TEST(TraitsTest, LieAllOverTheSurface) {
  const CanonicalMesh mesh = BlockMeshOf(8);
  const TraitPlaces places = ChooseTraits(mesh);
  ASSERT_EQ(static_cast<int>(places.nodes.size()), kTraitNodes);
  EXPECT_EQ(std::set<int>(places.nodes.begin(), places.nodes.end()).size(), places.nodes.size());
  EXPECT_EQ(places.elements.size(), places.nodes.size());
  for (int node = 0; node < mesh.surface_nodes; ++node) {
    double nearest = mesh.size;
    for (const int chosen : places.nodes) {
      EXPECT_LT(chosen, mesh.surface_nodes);
      nearest = std::min(nearest, (mesh.nodes.col(node) - mesh.nodes.col(chosen)).norm());
    }
    EXPECT_LT(nearest, mesh.size / 4);
  }
}

TEST(TraitsTest, AreAllNodesOfASmallMesh) {
  const CanonicalMesh mesh = BlockMeshOf(1);
  EXPECT_EQ(static_cast<int>(ChooseTraits(mesh).nodes.size()), mesh.surface_nodes);
}

TEST(TraitsTest, ArePlacesAndThenValuesOfEachField) {
  const CanonicalMesh mesh = BlockMeshOf(3);
  const TraitPlaces places = ChooseTraits(mesh);
  const Eigen::MatrixXd temperature = Eigen::RowVectorXd::LinSpaced(mesh.node_count(), 0, 1);
  const Eigen::MatrixXd stress = Eigen::RowVectorXd::LinSpaced(mesh.element_count(), 2, 3);
  const std::vector<float> traits = TraitsOf({mesh.nodes, {temperature, stress}}, mesh, places);
  const std::size_t nodes = places.nodes.size();
  ASSERT_EQ(traits.size(), 4 * nodes + places.elements.size());
  for (std::size_t n = 0; n < nodes; ++n) {
    for (int d = 0; d < 3; ++d) {
      EXPECT_EQ(traits[3 * n + d], static_cast<float>(mesh.nodes(d, places.nodes[n])));
    }
    EXPECT_EQ(traits[3 * nodes + n], static_cast<float>(temperature(0, places.nodes[n])));
    EXPECT_EQ(traits[4 * nodes + n], static_cast<float>(stress(0, places.elements[n])));
  }
}

}  // namespace
}  // namespace mortise::interpolator
