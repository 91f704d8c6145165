// Mesh files read in a process of their own: its limits, and damaged files, over which it may end.
#include "common/mesh/scenes/scene_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/errors.h"
#include "common/mesh/scenes/mesh_components.h"
#include "tests/support/file_damage.h"
#include "tests/support/scene_files.h"
#include "tests/support/status_assertions.h"

namespace mortise::mesh {
namespace {

using ::testing::HasSubstr;

constexpr int kDamages = 5;  // of each kind to each file

struct Whole {
  std::string name;
  std::string bytes;
};

std::vector<Whole> Files() {
  const auto mesh = testing::Sheet(12);
  return {{"a.obj", testing::WriteObj(mesh)},
          {"a.off", testing::WriteOff(mesh)},
          {"a.ply", testing::WriteTextPly(mesh)},
          {"b.ply", testing::WriteBinaryPly(mesh)},
          {"c.ply", testing::WriteBinaryPly(mesh, true)},
          {"a.stl", testing::WriteTextStl(mesh, "a")},
          {"b.stl", testing::WriteBinaryStl(mesh)},
          {"a.glb", testing::WriteGlb(mesh)},
          {"a.gltf", testing::PackGltf(testing::GltfDocument(mesh), testing::GltfBuffer(mesh))}};
}

void ExpectSound(const Scene& scene) {
  for (const SceneComponent& component : scene.components) {
    EXPECT_TRUE(component.vertices.allFinite());
    ASSERT_GT(component.triangles.cols(), 0);
    EXPECT_GE(component.triangles.minCoeff(), 0);
    EXPECT_LT(component.triangles.maxCoeff(), component.vertices.cols());
  }
}

TEST(SceneReader, ReadsEveryFormat) {
  for (const Whole& file : Files()) {
    const auto scene = ReadScene(file.bytes, file.name);
    ASSERT_TRUE(scene.ok()) << file.name << ": " << scene.status();
    EXPECT_EQ(TriangleCount(*scene), 288) << file.name;
    EXPECT_EQ(scene->components[0].vertices.cols(), 169) << file.name;
    EXPECT_TRUE(scene->notes.empty()) << file.name;
  }
}

TEST(SceneReader, HandsOnWhatIsRefused) {
  const auto scene = ReadScene("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "a\nb.obj");
  EXPECT_EQ(scene.status().message(), "file: line 4: a face names vertex 4 of 3");
  EXPECT_EQ(DetailOf(scene.status()).field, "file");
  const auto empty = ReadScene("", "");
  EXPECT_EQ(empty.status().message(), "file: is empty");
}

TEST(SceneReader, OutlivesDamagedFiles) {
  std::mt19937 random(11);
  int refused = 0;
  for (const Whole& file : Files()) {
    for (int damage = 0; damage < testing::kDamages; ++damage) {
      for (int i = 0; i < kDamages; ++i) {
        const auto scene = ReadScene(
            testing::Damaged(file.bytes, static_cast<testing::Damage>(damage), random), file.name);
        if (scene.ok()) {
          ExpectSound(*scene);
          continue;
        }
        ++refused;
        EXPECT_EQ(DetailOf(scene.status()).field, "file") << file.name << scene.status();
        EXPECT_THAT(scene.status().code(), ::testing::AnyOf(absl::StatusCode::kInvalidArgument,
                                                            absl::StatusCode::kResourceExhausted));
      }
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(SceneReader, ReadsAMillionTriangles) {
  const auto mesh = testing::Sheet(708);
  for (const std::string& bytes : {testing::WriteBinaryPly(mesh), testing::WriteGlb(mesh)}) {
    ASSERT_OK_AND_ASSIGN(const Scene scene, ReadScene(bytes, ""));
    EXPECT_EQ(TriangleCount(scene), 2 * 708 * 708);
    EXPECT_EQ(FindConnected(scene.components[0].vertices, scene.components[0].triangles).count, 1);
  }
}

TEST(SceneReader, ReadsAsManyTrianglesAsItSaysAndNoMore) {
  auto mesh = testing::Sheet(1000);
  for (const std::string& bytes : {testing::WriteBinaryPly(mesh), testing::WriteGlb(mesh)}) {
    ASSERT_OK_AND_ASSIGN(const Scene scene, ReadScene(bytes, ""));
    EXPECT_EQ(TriangleCount(scene), kMaxSceneTriangles);
  }
  mesh.triangles.conservativeResize(3, mesh.triangles.cols() + 1);
  mesh.triangles.rightCols(1) = mesh.triangles.leftCols(1);
  for (const std::string& bytes : {testing::WriteBinaryPly(mesh), testing::WriteGlb(mesh)}) {
    const auto refused = ReadScene(bytes, "");
    EXPECT_EQ(refused.status().code(), absl::StatusCode::kResourceExhausted);
    EXPECT_THAT(std::string(refused.status().message()), HasSubstr("2,000,000 triangles"));
  }
}

TEST(SceneReader, RefusesFilesThatAreTooLargeWithoutAChild) {
  SceneReaderOptions options;
  options.program = "/nonexistent/program";
  const std::string large(kMaxSceneBytes + 1, ' ');
  EXPECT_EQ(ReadScene(large, "", options).status().code(), absl::StatusCode::kResourceExhausted);
}

TEST(SceneReader, TellsWhenMemoryEnds) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer reserves addresses without end, so they are not limited";
#endif
  // Numbers by the million take many times their bytes, before anything is known of the mesh.
  std::string json = "{\"asset\":{\"version\":\"2.0\"},\"extras\":[0";
  while (json.size() < kMaxSceneBytes - 100) json += ",[0]";
  const auto scene = ReadScene(json + "]}", "a.gltf");
  EXPECT_EQ(scene.status().code(), absl::StatusCode::kResourceExhausted) << scene.status();
  EXPECT_THAT(std::string(scene.status().message()), HasSubstr("1 GiB"));
}

TEST(SceneReader, TellsWhenTimeIsUp) {
  SceneReaderOptions options;
  options.time_limit = std::chrono::seconds(0);
  EXPECT_EQ(ReadScene("x", "", options).status().code(), absl::StatusCode::kResourceExhausted);
}

TEST(SceneReader, TellsThatTheChildFails) {
  SceneReaderOptions options;
  options.program = "/bin/false";
  const auto scene = ReadScene("x", "", options);
  EXPECT_EQ(scene.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(scene.status().message()), HasSubstr("fails over it"));
  options.program = "/nonexistent/program";
  EXPECT_EQ(ReadScene("x", "", options).status().code(), absl::StatusCode::kInternal);
}

}  // namespace
}  // namespace mortise::mesh

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == mortise::mesh::kSceneChildArgument) {
    return mortise::mesh::RunSceneChild();
  }
  ::testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
