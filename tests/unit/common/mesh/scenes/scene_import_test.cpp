#include "common/mesh/scenes/scene_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"
#include "tests/support/scene_files.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/scenes/refusals.h"

namespace mortise::mesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SceneImport, ReadsAFileByItsContentAndSaysSo) {
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene(testing::WriteBinaryPly(testing::Tetrahedron()), "chair.OBJ"));
  EXPECT_EQ(TriangleCount(scene), 4);
  EXPECT_THAT(scene.notes,
              ElementsAre("The file is called OBJ, but is PLY, and was read as such."));
}

TEST(SceneImport, RefusesGarbageAndOtherFormats) {
  EXPECT_THAT(Refusal("", "chair.obj"), HasSubstr("is empty"));
  EXPECT_THAT(Refusal("ISO-10303-21;", "chair.obj"), HasSubstr("is a STEP file"));
  std::mt19937 random(3);
  std::string garbage(10'000, ' ');
  for (char& byte : garbage) byte = static_cast<char>(random());
  for (const char* name : {"a.obj", "a.off", "a.ply", "a.glb", "a.gltf", "a.stl", "a", ""}) {
    EXPECT_NE(Refusal(garbage, name), "");
  }
}

TEST(SceneImport, TakesATriangleAndAFlatMesh) {
  auto mesh = testing::Sheet(3);
  mesh.points.row(2).setZero();
  ASSERT_OK_AND_ASSIGN(const Scene flat, ImportScene(testing::WriteObj(mesh), "a.obj"));
  EXPECT_EQ(TriangleCount(flat), 18);
  ASSERT_OK_AND_ASSIGN(const Scene one, ImportScene("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ""));
  EXPECT_EQ(TriangleCount(one), 1);
}

TEST(SceneImport, TakesSurfacesThatAreNoSolids) {
  // Three triangles at one edge, one of them flipped, and one that crosses them.
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv .2 .2 -1\n"
                                   "v .3 .2 1\nv .2 .3 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 6 7 8\n",
                                   "a.obj"));
  EXPECT_EQ(TriangleCount(scene), 4);
}

TEST(SceneImport, TakesTooManyGroupsAsOne) {
  std::string text = testing::WriteObj(testing::Tetrahedron());
  for (std::size_t i = 0; i <= kMaxSceneComponents; ++i) {
    absl::StrAppend(&text, "g ", i, "\nf 1 2 3\n");
  }
  ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(text, ""));
  ASSERT_EQ(scene.components.size(), 1u);
  EXPECT_EQ(scene.components[0].name, "");
  EXPECT_EQ(TriangleCount(scene), static_cast<std::int64_t>(kMaxSceneComponents) + 5);
  EXPECT_THAT(scene.notes, ElementsAre(HasSubstr("they were taken as one")));
}

TEST(SceneImport, TakesTooManyNodesAsOne) {
  nlohmann::json document = testing::GltfDocument(testing::Tetrahedron());
  for (std::size_t i = 1; i <= kMaxSceneComponents; ++i) {
    document["nodes"].push_back({{"mesh", 0}, {"name", "bolt"}});
    document["scenes"][0]["nodes"].push_back(i);
  }
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene(testing::PackGlb(document, testing::GltfBuffer(testing::Tetrahedron())), ""));
  ASSERT_EQ(scene.components.size(), 1u);
  EXPECT_EQ(TriangleCount(scene), 4 * (static_cast<std::int64_t>(kMaxSceneComponents) + 1));
  EXPECT_THAT(scene.notes, ElementsAre(HasSubstr("they were taken as one")));
}

TEST(SceneImport, CutsLongNames) {
  const std::string name(100'000, 'n');
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene(absl::StrCat("v 0 0 0\nv 1 0 0\nv 0 1 0\ng ", name, "\nf 1 2 3\n"), ""));
  EXPECT_EQ(scene.components[0].name, name.substr(0, kMaxSceneNameBytes));
}

TEST(SceneImport, RefusesMoreTrianglesThanItReads) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  std::string text = points;
  text.reserve(20 << 20);
  for (std::int64_t i = 0; i <= kMaxSceneTriangles; ++i) text += "f 1 2 3\n";
  EXPECT_THAT(Refusal(text, "", absl::StatusCode::kResourceExhausted),
              HasSubstr("2,000,000 triangles"));
}

TEST(SceneImport, RefusesFilesThatAreTooLarge) {
  EXPECT_THAT(
      Refusal(std::string(kMaxSceneBytes + 1, ' '), "", absl::StatusCode::kResourceExhausted),
      HasSubstr("64 MiB"));
}

}  // namespace
}  // namespace mortise::mesh
