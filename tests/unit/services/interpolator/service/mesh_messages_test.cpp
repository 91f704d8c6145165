// Canonical meshes as messages: whole, and cut into parts.
#include "services/interpolator/service/mesh_messages.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <map>
#include <string>

#include "tests/support/bar_design.h"

namespace mortise::interpolator {
namespace {

TEST(MeshMessagesTest, PartsPutTogetherAreTheWhole) {
  const CanonicalMesh mesh = CanonicalMesh::Create(testing::BarDesign(0.5, 11, 5)).value();
  for (const v1::GeometryKind geometry : {v1::SURFACE, v1::TETRAHEDRA}) {
    const std::vector<v1::MapMesh> whole =
        MeshMessages(mesh, 2, 3, geometry, std::numeric_limits<std::size_t>::max());
    ASSERT_EQ(whole.size(), 1u);
    EXPECT_EQ(whole[0].structure(), 2);
    EXPECT_EQ(whole[0].mesh(), 3);
    EXPECT_FALSE(whole[0].more());
    ASSERT_EQ(whole[0].triangles().size(), 12u * static_cast<std::size_t>(mesh.triangles.cols()));
    int corner = 0;
    std::memcpy(&corner, whole[0].triangles().data() + 4, 4);
    EXPECT_EQ(corner, mesh.triangles(1, 0));
    v1::MapMesh together;
    const std::vector<v1::MapMesh> parts = MeshMessages(mesh, 2, 3, geometry, 101);
    EXPECT_GT(parts.size(), 3u);
    for (const v1::MapMesh& part : parts) {
      std::size_t bytes = part.triangles().size() + part.tetrahedra().size() + part.parts().size();
      for (const auto& region : part.regions()) bytes += region.triangles().size();
      EXPECT_LE(bytes, 101u);
      EXPECT_EQ(part.more(), &part != &parts.back());
      together.mutable_triangles()->append(part.triangles());
      together.mutable_tetrahedra()->append(part.tetrahedra());
      together.mutable_parts()->append(part.parts());
    }
    EXPECT_EQ(together.triangles(), whole[0].triangles());
    EXPECT_EQ(together.tetrahedra(), whole[0].tetrahedra());
    EXPECT_EQ(together.parts(), whole[0].parts());
    EXPECT_EQ(together.tetrahedra().size(),
              geometry == v1::SURFACE ? 0 : 16u * static_cast<std::size_t>(mesh.element_count()));
  }
}

// All triangles on the outside, twice, and a region of none.
CanonicalMesh MeshWithLargeRegions() {
  fields::DesignFields bar = testing::BarDesign(0.5, 11, 5);
  fields::Region all{"all", {}};
  for (int t = 0; t < bar.triangles.cols(); ++t) all.triangles.push_back(t);
  bar.regions = {all, {"none", {}}, all};
  bar.regions[2].name = "all again";
  return CanonicalMesh::Create(bar).value();
}

TEST(MeshMessagesTest, CutsRegionsThatAreLarge) {
  const CanonicalMesh mesh = MeshWithLargeRegions();
  std::map<std::string, std::string> together;
  int cut = 0;
  for (const v1::MapMesh& part : MeshMessages(mesh, 0, 0, v1::SURFACE, 64)) {
    std::size_t bytes = part.triangles().size() + part.parts().size();
    for (const auto& region : part.regions()) {
      together[region.name()] += region.triangles();
      bytes += region.triangles().size();
      ++cut;
    }
    EXPECT_LE(bytes, 64u);
  }
  EXPECT_GT(cut, 6);
  const auto whole = MeshMessages(mesh, 0, 0, v1::SURFACE, std::numeric_limits<std::size_t>::max());
  ASSERT_EQ(whole.size(), 1u);
  ASSERT_EQ(whole[0].regions_size(), static_cast<int>(together.size()));
  for (const auto& region : whole[0].regions()) {
    EXPECT_EQ(together.at(region.name()), region.triangles());
  }
}

TEST(MeshMessagesTest, SendsAMeshAheadWhereItDoesNotFitWithTheShape) {
  const CanonicalMesh mesh = MeshWithLargeRegions();
  v1::MapShape shape;
  shape.set_sequence(7);
  shape.set_structure(2);
  shape.set_mesh(3);
  shape.set_positions(std::string(3000, 'x'));
  const std::vector<v1::MapMesh> parts = MeshMessages(mesh, 2, 3, v1::SURFACE, 400);
  ASSERT_GT(parts.size(), 2u);
  const auto roomy = WithMesh(shape, parts, 10000);
  EXPECT_EQ(roomy.size(), parts.size());
  const auto narrow = WithMesh(shape, parts, 3100);
  EXPECT_EQ(narrow.size(), parts.size() + 1);
  for (const auto& messages : {roomy, narrow}) {
    v1::MapMesh together;
    for (const v1::MapShape& message : messages) {
      const bool is_last = &message == &messages.back();
      EXPECT_EQ(message.sequence(), 7);
      EXPECT_EQ(message.structure(), 2);
      EXPECT_EQ(message.mesh(), 3);
      EXPECT_EQ(message.positions().empty(), !is_last);
      EXPECT_EQ(message.new_mesh().more(), !is_last);
      EXPECT_EQ(message.new_mesh().nodes(), mesh.surface_nodes);
      EXPECT_EQ(message.new_mesh().part_names_size(), is_last ? 1 : 0);
      together.mutable_triangles()->append(message.new_mesh().triangles());
      together.mutable_parts()->append(message.new_mesh().parts());
    }
    EXPECT_EQ(together.triangles().size(), 12u * static_cast<std::size_t>(mesh.triangles.cols()));
    EXPECT_EQ(together.parts().size(), 4u * static_cast<std::size_t>(mesh.triangles.cols()));
  }
  for (const v1::MapShape& message : narrow) EXPECT_LE(message.ByteSizeLong(), 3100u);
}

}  // namespace
}  // namespace mortise::interpolator
