// Wavefront OBJ as programs write it, and as it should not be written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/mesh/scenes/scene_import.h"
#include "tests/support/scene_files.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/scenes/refusals.h"

namespace mortise::mesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjFile, HasItsObjectsAndGroupsAsComponents) {
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene(std::string(kSquare) + "o chair\nf 1 2 3\ng left leg\nf 1 3 4\ng back\nf 2 3 4\n"
                                         "g left leg\nf 1 2 4\n",
                  "chair.obj"));
  ASSERT_EQ(scene.components.size(), 3u);
  EXPECT_EQ(scene.components[0].name, "chair");
  EXPECT_EQ(scene.components[1].name, "left leg");
  EXPECT_EQ(scene.components[2].name, "back");
  EXPECT_EQ(scene.components[1].triangles.cols(), 2);
  EXPECT_FALSE(scene.unit);
  EXPECT_EQ(scene.up, UpAxis::kUnknown);
  EXPECT_THAT(scene.notes, ElementsAre());
}

TEST(ObjFile, IsOneComponentWhereOnlyMaterialsChange) {
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene("mtllib /etc/passwd\n" + std::string(kSquare) +
                                       "usemtl oak\nf 1 2 3\nusemtl steel\nf 1 3 4\n",
                                   "chair.obj"));
  ASSERT_EQ(scene.components.size(), 1u);
  EXPECT_EQ(scene.components[0].name, "");
  EXPECT_EQ(scene.components[0].triangles.cols(), 2);
  EXPECT_EQ(scene.components[0].vertices.cols(), 4);
}

TEST(ObjFile, CountsNegativeIndicesBack) {
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n", ""));
  const SceneComponent& only = scene.components[0];
  ASSERT_EQ(only.vertices.cols(), 3);
  EXPECT_EQ(only.vertices.col(only.triangles(1, 0)), Eigen::Vector3d(1, 0, 0));
}

TEST(ObjFile, IsDividedIntoTrianglesWhereItsFacesAreNotConvex) {
  // An arrow head of five corners: its area shows that no triangle lies outside.
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n", ""));
  const SceneComponent& head = scene.components[0];
  ASSERT_EQ(head.triangles.cols(), 3);
  double area = 0;
  for (const auto& corners : head.triangles.colwise()) {
    const Eigen::Vector3d a = head.vertices.col(corners(0)), b = head.vertices.col(corners(1)),
                          c = head.vertices.col(corners(2));
    area += (b - a).cross(c - a).z() / 2;
  }
  EXPECT_NEAR(area, 10, 1e-6);
  EXPECT_THAT(scene.notes,
              ElementsAre("Faces of more than three corners, divided into triangles: 1."));
}

TEST(ObjFile, IsReadWithWindowsLineEndsCommentsAndContinuedLines) {
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene(
          "\xEF\xBB\xBF# chair\r\nv 0 0 0 # corner\r\nv 1 0 0 0.5 0.5 0.5\r\nv \\\r\n0 2 0\r\n"
          "vn 0 0 1\r\nvt 0 0\r\no Stuhl \xC3\xA4\r\nf 1/1/1 2//1 \\\r\n3/1\r\nl 1 2\r\np 1\r\n",
          "stuhl.obj"));
  ASSERT_EQ(scene.components.size(), 1u);
  EXPECT_EQ(scene.components[0].name, "Stuhl \xC3\xA4");
  EXPECT_EQ(scene.components[0].triangles.cols(), 1);
  EXPECT_EQ(BoxOf(scene).sizes(), Eigen::Vector3d(1, 2, 0));
}

TEST(ObjFile, MayHaveItsNumbersInAnyForm) {
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene("v .5 -.25 +1\nv 1.5e0 5E-1 1.\nv 0.0000001 123456.7 1\nf 1 02 +3\n", ""));
  const SceneComponent& only = scene.components[0];
  Eigen::Matrix3d expected;
  expected << 0.5, 1.5, 0.0000001, -0.25, 0.5, 123456.7, 1, 1, 1;
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(only.vertices.col(only.triangles(k, 0)).isApprox(expected.col(k), 1e-6));
  }
}

TEST(ObjFile, DividesCoordinatesByTheirWeight) {
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene("v 0 0 0 1\nv 4 0 0 2\nv 0 2 0 1.0\nf 1 2 3\n", ""));
  EXPECT_EQ(BoxOf(scene).sizes(), Eigen::Vector3d(2, 2, 0));
}

TEST(ObjFile, HasNamesOfUtf8EvenIfItsNamesAreNot) {
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene(std::string(kSquare) + "o caf\xE9 \x01!\nf 1 2 3\n", ""));
  EXPECT_EQ(scene.components[0].name, "caf\xEF\xBF\xBD  !");
}

TEST(ObjFile, KeepsDoubledAndFlippedTriangles) {
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene(std::string(kSquare) + "f 1 2 3\nf 1 2 3\nf 3 2 1\n", ""));
  EXPECT_EQ(scene.components[0].triangles.cols(), 3);
  EXPECT_EQ(scene.components[0].vertices.cols(), 3);
}

TEST(ObjFile, LosesTrianglesWithoutAreaAndSaysSo) {
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene(std::string(kSquare) + "f 1 2 3\nf 1 1 2\nf 1 2\n", ""));
  EXPECT_EQ(scene.components[0].triangles.cols(), 1);
  EXPECT_THAT(scene.notes, ElementsAre("Faces of fewer than three corners, left out: 1.",
                                       "Triangles without area, left out: 1."));
  EXPECT_THAT(Refusal(std::string(kSquare) + "f 1 1 2\n"),
              HasSubstr("no triangle that has an area"));
}

TEST(ObjFile, IsRefusedWithTheLineAtFault) {
  EXPECT_THAT(Refusal(std::string(kSquare) + "f 1 2 5\n"),
              HasSubstr("line 5: a face names vertex 5 of 4"));
  EXPECT_THAT(Refusal(std::string(kSquare) + "f 1 2 -5\n"), HasSubstr("line 5: "));
  EXPECT_THAT(Refusal(std::string(kSquare) + "f 1 2 0\n"),
              HasSubstr("line 5: \"0\" names no vertex"));
  EXPECT_THAT(Refusal(std::string(kSquare) + "f 1 2 99999999999999999999\n"),
              HasSubstr("line 5: "));
  EXPECT_THAT(Refusal("v 0 0 0\nv 1 nan 0\nv 1 1 0\nf 1 2 3\n"),
              HasSubstr("line 2: a coordinate is not finite"));
  EXPECT_THAT(Refusal("v 0 0 0\nv 1 0 -inf\nv 1 1 0\nf 1 2 3\n"), HasSubstr("line 2: "));
  EXPECT_THAT(Refusal("v 0 0 0\nv 1 0\nv 1 1 0\nf 1 2 3\n"),
              HasSubstr("fewer than three coordinates"));
  EXPECT_THAT(Refusal("v 0 0 0\nv 1 x 0\nv 1 1 0\nf 1 2 3\n"), HasSubstr("\"x\" is no number"));
  EXPECT_THAT(Refusal(kSquare), HasSubstr("no faces"));
}

TEST(ObjFile, IsRefusedWhereItsNumbersAreBeyondSinglePrecision) {
  EXPECT_THAT(Refusal("v 0 0 0\nv 1e300 0 0\nv 1 1 0\nf 1 2 3\n"),
              HasSubstr("line 2: a coordinate is larger than 3.4e38"));
}

}  // namespace
}  // namespace mortise::mesh
