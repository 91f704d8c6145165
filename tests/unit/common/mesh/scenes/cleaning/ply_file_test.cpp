#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/mesh/scenes/scene_import.h"
#include "tests/support/scene_files.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/scenes/refusals.h"

namespace mortise::mesh {
namespace {

using ::testing::HasSubstr;
using testing::PlainMesh;

// A header with these elements, and what follows it.
std::string Ply(const std::string& elements, const std::string& data,
                const std::string& format = "ascii") {
  return absl::StrCat("ply\nformat ", format, " 1.0\n", elements, "end_header\n", data);
}

constexpr const char* kPoints =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
constexpr const char* kOneFace = "element face 1\nproperty list uchar int vertex_index\n";

void ExpectMesh(const Scene& scene, const PlainMesh& mesh) {
  ASSERT_EQ(scene.components.size(), 1u);
  const SceneComponent& read = scene.components[0];
  ASSERT_EQ(read.triangles.cols(), mesh.triangles.cols());
  for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) {
    EXPECT_TRUE(read.vertices.col(read.triangles.reshaped()(i))
                    .isApprox(mesh.points.col(mesh.triangles.reshaped()(i)).cast<double>(), 1e-5));
  }
}

TEST(PlyFile, IsReadAsTextAndInEitherByteOrder) {
  const PlainMesh mesh = testing::Sheet(5);
  for (const std::string& bytes :
       {testing::WriteTextPly(mesh), testing::WriteBinaryPly(mesh, false),
        testing::WriteBinaryPly(mesh, true)}) {
    ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(bytes, "a.ply"));
    ExpectMesh(scene, mesh);
  }
}

TEST(PlyFile, MayHaveDataThatBeginLikeALinesEnd) {
  for (const unsigned char first : {0x0A, 0x0D, 0x20, 0x09}) {
    PlainMesh mesh = testing::Tetrahedron();
    std::uint32_t bits = 0x3F800000u | first;
    std::memcpy(&mesh.points(0, 0), &bits, sizeof bits);
    ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(testing::WriteBinaryPly(mesh), "a.ply"));
    ExpectMesh(scene, mesh);
  }
}

TEST(PlyFile, IsReadWithWindowsLineEnds) {
  const PlainMesh mesh = testing::Tetrahedron();
  const std::string text = testing::WriteTextPly(mesh);
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene(absl::StrReplaceAll(text, {{"\n", "\r\n"}}), "a.ply"));
  ExpectMesh(scene, mesh);
  const std::string binary = testing::WriteBinaryPly(mesh);
  const std::size_t data = binary.find("end_header\n") + 11;
  ASSERT_OK_AND_ASSIGN(
      const Scene same,
      ImportScene(absl::StrCat(absl::StrReplaceAll(binary.substr(0, data), {{"\n", "\r\n"}}),
                               binary.substr(data)),
                  "a.ply"));
  ExpectMesh(same, mesh);
}

TEST(PlyFile, MayHaveMoreThanASurface) {
  const std::string text =
      Ply("element camera 2\nproperty int id\nobj_info scanner\n"
          "element vertex 4\nproperty uchar red\nproperty double z\nproperty double y\n"
          "property double x\nproperty list uchar float weights\n"
          "element face 1\nproperty list uchar float texcoord\n"
          "property list uint8 uint32 vertex_indices\nelement edge 7\nproperty int a\n",
          "1\n2\n255 0 0 0 0\n255 0 0 1 2 5 5\n255 0 1 1 0\n255 0 1 0 0\n2 0.5 0.5 4 0 1 2 3\n");
  ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(text, "a.ply"));
  EXPECT_EQ(scene.components[0].triangles.cols(), 2);
  EXPECT_EQ(BoxOf(scene).sizes(), Eigen::Vector3d(1, 1, 0));
}

TEST(PlyFile, MayHaveMoreThanASurfaceInBinary) {
  std::string data("\1\2\7", 3);  // two cameras, and the first vertex' colour
  const auto add = [&](auto number) {
    data.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  const double points[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  for (int i = 0; i < 3; ++i) {
    if (i > 0) data += '\7';
    for (const double number : points[i]) add(number);
  }
  data += '\2';
  add(0.5f);
  add(0.5f);
  data += '\3';
  for (const std::uint16_t corner : {0, 1, 2}) add(corner);
  const std::string header =
      "element camera 2\nproperty char id\nelement vertex 3\nproperty uchar red\n"
      "property double x\nproperty double y\nproperty double z\n"
      "element face 1\nproperty list uchar float texcoord\n"
      "property list uchar ushort vertex_indices\n";
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene(Ply(header, data, "binary_little_endian"), "a.ply"));
  EXPECT_EQ(BoxOf(scene).sizes(), Eigen::Vector3d(1, 2, 0));
}

TEST(PlyFile, IsRefusedWhereItsIndicesAreOutOfRange) {
  PlainMesh mesh = testing::Tetrahedron();
  mesh.triangles(2, 3) = 4;
  EXPECT_THAT(Refusal(testing::WriteTextPly(mesh)), HasSubstr("a face names vertex 5 of 4"));
  EXPECT_THAT(Refusal(testing::WriteBinaryPly(mesh)), HasSubstr("face 4 names vertex 4"));
  mesh.triangles(2, 3) = -1;
  EXPECT_THAT(Refusal(testing::WriteTextPly(mesh)), HasSubstr("line 18"));
  EXPECT_THAT(Refusal(testing::WriteBinaryPly(mesh)), HasSubstr("face 4"));
}

TEST(PlyFile, IsRefusedWhereCoordinatesAreNotFinite) {
  PlainMesh mesh = testing::Sheet(2);
  mesh.points(1, 0) = std::nanf("");
  EXPECT_THAT(Refusal(testing::WriteBinaryPly(mesh)),
              HasSubstr("corners of triangles whose coordinates are not finite: 1, the first in "
                        "triangle 1 of the file"));
  EXPECT_THAT(Refusal(testing::WriteTextPly(mesh)), HasSubstr("not finite"));
}

TEST(PlyFile, IsRefusedWhereItDeclaresMoreThanItHas) {
  const std::string text = testing::WriteTextPly(testing::Tetrahedron());
  const std::string binary = testing::WriteBinaryPly(testing::Tetrahedron());
  for (const std::string& bytes : {text, binary}) {
    EXPECT_THAT(Refusal(absl::StrReplaceAll(bytes, {{"vertex 4\n", "vertex 2000000000\n"}})),
                HasSubstr("declares 2000000000 of the element vertex"));
    EXPECT_THAT(Refusal(bytes.substr(0, bytes.size() - 8)), HasSubstr("face, but ends after 3"));
  }
  EXPECT_THAT(Refusal(absl::StrReplaceAll(binary, {{"face 4\n", "face 2000000000\n"}})),
              HasSubstr("ends after 4"));
  // A list of four thousand million corners.
  std::string list = Ply(
      absl::StrCat(kPoints, "element face 1\nproperty list uint int vertex_index\n"),
      std::string(36, '\0') + "\xFF\xFF\xFF\xFF" + std::string(12, '\0'), "binary_little_endian");
  EXPECT_THAT(Refusal(list), HasSubstr("ends after 0"));
}

TEST(PlyFile, IsRefusedWithWhatItLacks) {
  const std::string data = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_THAT(Refusal(Ply(kPoints, data)), HasSubstr("points, but no faces"));
  EXPECT_THAT(Refusal(Ply(kOneFace, data)), HasSubstr("not one list of vertices"));
  EXPECT_THAT(Refusal(Ply(absl::StrCat(kOneFace, kPoints), data)),
              HasSubstr("before its vertices"));
  EXPECT_THAT(Refusal(Ply(absl::StrCat("element vertex 3\nproperty float x\n", kOneFace), data)),
              HasSubstr("without y"));
  EXPECT_THAT(Refusal(Ply(absl::StrCat(kPoints, "element face 1\nproperty int a\n"), data)),
              HasSubstr("without vertex_indices"));
  EXPECT_THAT(Refusal(Ply(absl::StrCat(kPoints, kPoints, kOneFace), data)),
              HasSubstr("not one list of vertices"));
  EXPECT_THAT(Refusal(Ply(absl::StrCat(kPoints, kOneFace), data, "ebcdic")), HasSubstr("line 2"));
  EXPECT_THAT(Refusal("ply\nformat ascii 1.0\n"), HasSubstr("header without end"));
  EXPECT_THAT(Refusal(Ply("element vertex many\n", data)), HasSubstr("line 3"));
  EXPECT_THAT(Refusal(Ply("element vertex 3\nproperty text x\n", data)), HasSubstr("line 4"));
  EXPECT_THAT(Refusal(Ply(absl::StrCat(kPoints, kOneFace), "0 0 0\n1 0\n0 1 0\n3 0 1 2\n")),
              HasSubstr("line 11"));
}

}  // namespace
}  // namespace mortise::mesh
