#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/mesh/scenes/scene_import.h"
#include "tests/support/scene_files.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/scenes/refusals.h"

namespace mortise::mesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::PlainMesh;

TEST(StlFile, IsReadAsTextAndBinaryWithCornersJoined) {
  const PlainMesh mesh = testing::Sheet(4);
  for (const std::string& bytes :
       {testing::WriteTextStl(mesh, "top"), testing::WriteBinaryStl(mesh)}) {
    ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(bytes, "a.stl"));
    ASSERT_EQ(scene.components.size(), 1u);
    EXPECT_EQ(scene.components[0].triangles.cols(), mesh.triangles.cols());
    EXPECT_EQ(scene.components[0].vertices.cols(), mesh.points.cols());
    EXPECT_FALSE(scene.unit);
    EXPECT_THAT(scene.notes, ElementsAre());
  }
}

TEST(StlFile, HasItsSolidsAsComponents) {
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene(absl::StrCat(testing::WriteTextStl(testing::Tetrahedron(), "left leg"),
                               testing::WriteTextStl(testing::Sheet(2), "Platte \xC3\xBC")),
                  "a.stl"));
  ASSERT_EQ(scene.components.size(), 2u);
  EXPECT_EQ(scene.components[0].name, "left leg");
  EXPECT_EQ(scene.components[1].name, "Platte \xC3\xBC");
}

TEST(StlFile, OfOneFlatTriangleIsRead) {
  PlainMesh mesh = testing::Tetrahedron();
  mesh.triangles = mesh.triangles.leftCols(1).eval();
  for (const std::string& bytes :
       {testing::WriteTextStl(mesh, ""), testing::WriteBinaryStl(mesh)}) {
    ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(bytes, "a.stl"));
    EXPECT_EQ(TriangleCount(scene), 1);
  }
}

TEST(StlFile, ThatBeginsWithSolidMayBeBinary) {
  std::string bytes = testing::WriteBinaryStl(testing::Tetrahedron());
  bytes.replace(0, 24, "solid COLOR=rgba of CAD ");
  ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(bytes, "a.stl"));
  EXPECT_EQ(TriangleCount(scene), 4);
}

TEST(StlFile, MayBeLongerThanItDeclaresAndSaysSo) {
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene(testing::WriteBinaryStl(testing::Tetrahedron()) + "trailer", "a.stl"));
  EXPECT_EQ(TriangleCount(scene), 4);
  EXPECT_THAT(scene.notes, ElementsAre("Bytes behind the last facet, left out: 7."));
}

TEST(StlFile, IsReadWhateverItsNormalsAre) {
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene("solid\r\nfacet normal -1.#IND nan(ind) x\r\nouter loop\r\n"
                                   "vertex 0 0 0\r\nvertex 1 0 0\r\nvertex 0 1 0\r\n",
                                   "a.stl"));
  EXPECT_EQ(TriangleCount(scene), 1);
}

TEST(StlFile, IsRefusedWhereItIsShorterThanItDeclares) {
  const std::string bytes = testing::WriteBinaryStl(testing::Tetrahedron());
  EXPECT_THAT(Refusal(bytes.substr(0, 200), "a.stl"),
              HasSubstr("declares 4 facets, but has room for 2"));
  std::string bomb = bytes;
  bomb.replace(80, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_THAT(Refusal(bomb, "a.stl"), HasSubstr("declares 4294967295 facets"));
}

TEST(StlFile, IsRefusedWithWhatIsWrong) {
  PlainMesh mesh = testing::Tetrahedron();
  mesh.points(2, 3) = std::numeric_limits<float>::infinity();
  EXPECT_THAT(Refusal(testing::WriteBinaryStl(mesh), "a.stl"),
              HasSubstr("corners of triangles whose coordinates are not finite: 3, the first in "
                        "triangle 2 of the file"));
  EXPECT_THAT(Refusal(testing::WriteTextStl(mesh, "a"), "a.stl"), HasSubstr("line 13"));
  EXPECT_THAT(Refusal("solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nendfacet\n", "a.stl"),
              HasSubstr("line 5: a facet has 2 vertices"));
  EXPECT_THAT(Refusal("solid\nfacet\nvertex 0 0\n", "a.stl"), HasSubstr("line 3"));
  EXPECT_THAT(Refusal("solid empty\nendsolid empty\n", "a.stl"), HasSubstr("no faces"));
}

TEST(StlFile, TakesFacetsOfOneLine) {
  const auto scene = ImportScene(
      "solid of one line\n"
      "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n"
      "facet normal 0 0 1 outer loop vertex 1 0 0 vertex 1 1 0 vertex 0 1 0 endloop endfacet\n"
      "endsolid of one line\n",
      "a.stl");
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_EQ(scene->components.size(), 1u);
  EXPECT_EQ(scene->components[0].name, "of one line");
  EXPECT_EQ(scene->components[0].triangles.cols(), 2);
  EXPECT_EQ(scene->components[0].vertices.cols(), 4);
}

}  // namespace
}  // namespace mortise::mesh
