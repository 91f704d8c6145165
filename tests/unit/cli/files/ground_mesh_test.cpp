// Meshes of ground: OBJ and STL.
#include "cli/files/ground_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/status_assertions.h"

namespace mortise::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(GroundMesh, IsReadFromObj) {
  ASSERT_OK_AND_ASSIGN(const v1::HeightTriangles triangles,
                       ParseObjGround("# scan\no ground\nv 451230.125 0 1\nv 1 0 1\nv 1 1 2\r\n"
                                      "v 0 1 2\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nf -4 -2 -1\n",
                                      "s.obj"));
  EXPECT_EQ(triangles.vertices_size(), 12);
  EXPECT_EQ(triangles.vertices(0), 451230.125) << "in double precision";
  EXPECT_THAT(triangles.triangles(), ElementsAre(0, 1, 2, 0, 2, 3, 0, 2, 3));
}

TEST(GroundMesh, IsReadFromStl) {
  const std::string text =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 0 1\nvertex 0 1 2\nendloop\n"
      "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 1\nvertex 1 1 2\nvertex 0 1 2\n"
      "endloop\nendfacet\nendsolid s\n";
  ASSERT_OK_AND_ASSIGN(const v1::HeightTriangles triangles, ParseStlGround(text, "s.stl"));
  EXPECT_EQ(triangles.vertices_size(), 12) << "corners at one place are one vertex";
  EXPECT_THAT(triangles.triangles(), ElementsAre(0, 1, 2, 1, 3, 2));
  std::string binary(84, '\0');
  binary[80] = 1;
  for (const float number :
       {0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.5F, 2.0F, 0.0F, 0.5F, 0.0F, 3.0F, 1.5F}) {
    binary.append(reinterpret_cast<const char*>(&number), sizeof(number));
  }
  binary.append(2, '\0');
  ASSERT_OK_AND_ASSIGN(const v1::HeightTriangles from_binary, ParseStlGround(binary, "s.stl"));
  EXPECT_THAT(from_binary.vertices(), ElementsAre(0, 0, 0.5, 2, 0, 0.5, 0, 3, 1.5));
}

TEST(GroundMesh, IsRefusedWithTheLine) {
  const auto obj = [](const std::string& text) {
    return std::string(ParseObjGround(text, "s.obj").status().message());
  };
  EXPECT_THAT(obj("v 0 0\n"), HasSubstr("s.obj: line 1: a vertex has three numbers"));
  EXPECT_THAT(obj("v 0 0 x\n"), HasSubstr("s.obj: line 1"));
  EXPECT_THAT(obj("v 0 0 0\nf 1 1 2\n"),
              HasSubstr("s.obj: line 2: there is no vertex 2; 1 stand before"));
  EXPECT_THAT(obj("v 0 0 0\nf 1 1\n"), HasSubstr("at least three corners"));
  EXPECT_THAT(obj("v 0 0 0\n"), HasSubstr("has no triangles"));
  EXPECT_THAT(
      std::string(
          ParseStlGround("solid s\nvertex 0 0 0\nvertex 1 0 0\n", "s.stl").status().message()),
      HasSubstr("ends within a triangle"));
}

}  // namespace
}  // namespace mortise::cli
