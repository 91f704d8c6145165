// Canonical meshes as messages: whole, and cut into parts.
#include "services/interpolator/service/mesh_messages.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

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
      EXPECT_LE(part.triangles().size() + part.tetrahedra().size() + part.parts().size(), 101u);
      EXPECT_EQ(part.more(), &part != &parts.back());
      EXPECT_EQ(part.regions_size(), part.more() ? 0 : 1);
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

}  // namespace
}  // namespace mortise::interpolator
