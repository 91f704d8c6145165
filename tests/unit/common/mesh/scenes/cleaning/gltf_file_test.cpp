// glTF 2.0 as GLB and JSON: what is read, and what must not be followed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/mesh/scenes/scene_import.h"
#include "tests/support/scene_files.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/scenes/refusals.h"

namespace mortise::mesh {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::PlainMesh;

// The tetrahedron's GLB with this in the place of what is at a JSON pointer of its document.
std::string Changed(const std::string& pointer, const json& value) {
  json document = testing::GltfDocument(testing::Tetrahedron());
  document[json::json_pointer(pointer)] = value;
  return testing::PackGlb(document, testing::GltfBuffer(testing::Tetrahedron()));
}

absl::StatusOr<Scene> ImportChanged(const std::string& pointer, const json& value) {
  return ImportScene(Changed(pointer, value), "a.glb");
}

TEST(GltfFile, IsInMetresWithYUp) {
  const PlainMesh mesh = testing::Sheet(4);
  const std::string gltf =
      testing::PackGltf(testing::GltfDocument(mesh), testing::GltfBuffer(mesh));
  for (const std::string& bytes : {testing::WriteGlb(mesh), gltf}) {
    ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(bytes, ""));
    EXPECT_EQ(scene.unit, 1);
    EXPECT_EQ(scene.up, UpAxis::kY);
    ASSERT_EQ(scene.components.size(), 1u);
    EXPECT_EQ(scene.components[0].name, "thing");
    const SceneComponent& thing = scene.components[0];
    ASSERT_EQ(thing.triangles.cols(), mesh.triangles.cols());
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) {
      EXPECT_EQ(thing.vertices.col(thing.triangles.reshaped()(i)),
                mesh.points.col(mesh.triangles.reshaped()(i)).cast<double>());
    }
    EXPECT_TRUE(BoxOf(scene).max().isApprox(mesh.points.rowwise().maxCoeff().cast<double>()));
    EXPECT_THAT(scene.notes, ElementsAre());
  }
}

TEST(GltfFile, HasTheTransformsOfItsNodesApplied) {
  const json nodes = json::parse(R"([
      {"name": "pair", "translation": [10, 0, 0], "scale": [2, 2, 2], "children": [1, 2]},
      {"name": "links", "mesh": 0},
      {"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1]},
      {"name": "not in the scene", "mesh": 0}])");
  ASSERT_OK_AND_ASSIGN(const Scene scene, ImportChanged("/nodes", nodes));
  ASSERT_EQ(scene.components.size(), 2u);
  EXPECT_THAT((std::vector{scene.components[0].name, scene.components[1].name}),
              ::testing::UnorderedElementsAre("links", ""));
  EXPECT_EQ(BoxOf(scene).min(), Eigen::Vector3d(8, 0, 0));
  EXPECT_EQ(BoxOf(scene).max(), Eigen::Vector3d(12, 12, 2));
}

TEST(GltfFile, IsNotInsideOutWhereANodeMirrors) {
  const json nodes = json::parse(R"([{"mesh": 0, "scale": [-1, 1, 1]}])");
  ASSERT_OK_AND_ASSIGN(const Scene scene, ImportChanged("/nodes", nodes));
  const SceneComponent& mirrored = scene.components[0];
  double volume = 0;
  for (const auto& corners : mirrored.triangles.colwise()) {
    volume += mirrored.vertices.col(corners(0))
                  .dot(mirrored.vertices.col(corners(1)).cross(mirrored.vertices.col(corners(2)))) /
              6;
  }
  EXPECT_NEAR(volume, 1.0 / 6, 1e-9);
}

TEST(GltfFile, MayHaveStripsFansAndNoIndices) {
  for (const auto& [mode, triangles] : {std::pair{4, 4}, {5, 10}, {6, 10}}) {
    ASSERT_OK_AND_ASSIGN(const Scene scene, ImportChanged("/meshes/0/primitives/0/mode", mode));
    EXPECT_LE(TriangleCount(scene), triangles);
    EXPECT_GT(TriangleCount(scene), 0);
  }
  json document = testing::GltfDocument(testing::Tetrahedron());
  document["meshes"][0]["primitives"][0].erase("indices");
  ASSERT_OK_AND_ASSIGN(
      const Scene bare,
      ImportScene(testing::PackGlb(document, testing::GltfBuffer(testing::Tetrahedron())), ""));
  EXPECT_EQ(TriangleCount(bare), 1);
}

TEST(GltfFile, IsReadWithoutItsPicturesAndAnimations) {
  json document = testing::GltfDocument(testing::Tetrahedron());
  document["images"] = {{{"uri", "/etc/passwd"}}};
  document["textures"] = {{{"source", 0}}};
  document["animations"] = {{{"channels", 7}}};
  document["skins"] = {{{"joints", {0}}}};
  document["extras"] = "anything";
  document["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  ASSERT_OK_AND_ASSIGN(
      const Scene scene,
      ImportScene(testing::PackGlb(document, testing::GltfBuffer(testing::Tetrahedron())), ""));
  EXPECT_EQ(TriangleCount(scene), 4);
  EXPECT_THAT(scene.notes, ElementsAre("Meshes of points or lines, left out: 1.",
                                       HasSubstr("Bones were left out")));
}

TEST(GltfFile, MayMoveSomePointsBySparseValues) {
  json document = testing::GltfDocument(testing::Tetrahedron());
  std::string buffer = testing::GltfBuffer(testing::Tetrahedron());
  const std::size_t at = buffer.size();
  buffer.append("\3\0\0\0", 4);
  const float moved[3] = {0, 0, 7};
  buffer.append(reinterpret_cast<const char*>(moved), sizeof moved);
  document["buffers"][0]["byteLength"] = buffer.size();
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", 4}});
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at + 4}, {"byteLength", 12}});
  document["accessors"][0]["sparse"] = json::parse(R"({"count": 1, "values": {"bufferView": 3},
      "indices": {"bufferView": 2, "componentType": 5121}})");
  ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(testing::PackGlb(document, buffer), ""));
  EXPECT_EQ(BoxOf(scene).max().z(), 7);
  document["accessors"][0]["sparse"]["count"] = 4;
  EXPECT_THAT(Refusal(testing::PackGlb(document, buffer)), HasSubstr("beyond its buffer view"));
}

TEST(GltfFile, IsRefusedWhereNodesAreWithinThemselves) {
  EXPECT_THAT(Refusal(Changed("/nodes", json::parse(R"([{"mesh": 0, "children": [0]}])"))),
              HasSubstr("nodes[0]"));
  EXPECT_THAT(Refusal(Changed("/nodes",
                              json::parse(R"([{"mesh": 0, "children": [1]}, {"children": [0]}])"))),
              HasSubstr("within a node"));
  EXPECT_THAT(Refusal(Changed("/nodes", json::parse(R"([{"children": [1, 1]}, {"mesh": 0}])"))),
              HasSubstr("in several nodes"));
  EXPECT_THAT(Refusal(Changed("/scenes/0/nodes", {0, 0})), HasSubstr("twice"));
  EXPECT_THAT(Refusal(Changed("/nodes/0/children", {8})), HasSubstr("not there"));
}

TEST(GltfFile, IsRefusedWhereItIsTooDeep) {
  json nodes = json::array();
  for (int i = 1; i < 300; ++i) nodes.push_back({{"children", {i}}});
  nodes.push_back({{"mesh", 0}});
  EXPECT_THAT(Refusal(Changed("/nodes", nodes)), HasSubstr("more than 256 deep"));
  const std::string brackets(1'000'000, '[');
  EXPECT_THAT(Refusal("{\"asset\":" + brackets, "a.gltf"), HasSubstr("more than 256 deep"));
}

TEST(GltfFile, IsRefusedWhereMeshesAreRepeatedWithoutEnd) {
  const PlainMesh mesh = testing::Sheet(100);
  json document = testing::GltfDocument(mesh);
  document["nodes"] = json::array();
  document["scenes"][0]["nodes"] = json::array();
  for (int i = 0; i < 101; ++i) {
    document["nodes"].push_back({{"mesh", 0}});
    document["scenes"][0]["nodes"].push_back(i);
  }
  EXPECT_THAT(Refusal(testing::PackGlb(document, testing::GltfBuffer(mesh)), "",
                      absl::StatusCode::kResourceExhausted),
              HasSubstr("2,000,000 triangles"));
}

TEST(GltfFile, IsRefusedWhereDataAreBeyondTheirBuffers) {
  EXPECT_THAT(Refusal(Changed("/bufferViews/1/byteLength", 4000)),
              HasSubstr("bufferViews[1] reaches beyond its buffer"));
  EXPECT_THAT(Refusal(Changed("/bufferViews/1/byteOffset", 4294967295u)),
              HasSubstr("bufferViews[1] reaches beyond its buffer"));
  EXPECT_THAT(Refusal(Changed("/bufferViews/0/buffer", 1)), HasSubstr("bufferViews[0]"));
  EXPECT_THAT(Refusal(Changed("/buffers/0/byteLength", 4000000000u)),
              HasSubstr("buffers[0] declares 4000000000 bytes, but has 96"));
  EXPECT_THAT(Refusal(Changed("/accessors/0/count", 5)),
              HasSubstr("accessors[0] reaches beyond its buffer view"));
  EXPECT_THAT(Refusal(Changed("/accessors/0/byteOffset", 8)), HasSubstr("accessors[0]"));
  EXPECT_THAT(Refusal(Changed("/bufferViews/0/byteStride", 200)), HasSubstr("accessors[0]"));
  EXPECT_THAT(Refusal(Changed("/accessors/1/bufferView", 9)), HasSubstr("accessors[1]"));
  EXPECT_THAT(
      Refusal(Changed("/accessors/1/count", 4000000000u), "", absl::StatusCode::kResourceExhausted),
      HasSubstr("triangles"));
}

TEST(GltfFile, IsRefusedWhereIndicesOrNumbersAreWrong) {
  PlainMesh mesh = testing::Tetrahedron();
  mesh.triangles(0, 2) = 4;
  EXPECT_THAT(Refusal(testing::WriteGlb(mesh)), HasSubstr("out-of-range indices"));
  mesh = testing::Tetrahedron();
  mesh.points(0, 0) = std::nanf("");
  EXPECT_THAT(Refusal(testing::WriteGlb(mesh)), HasSubstr("not finite"));
  EXPECT_THAT(Refusal(Changed("/nodes/0/scale", {1, 2})), HasSubstr("nodes[0].scale"));
  EXPECT_THAT(Refusal(Changed("/nodes/0/scale", {1e308, 1e308, 1e308})), HasSubstr("not finite"));
  EXPECT_THAT(Refusal(Changed("/nodes/0/mesh", 3)), HasSubstr("meshes[3] is not there"));
  EXPECT_THAT(Refusal(Changed("/nodes/0/mesh", "0")), HasSubstr("mesh is no whole number"));
  EXPECT_THAT(Refusal(Changed("/accessors/0/componentType", 5123)), HasSubstr("three floats"));
  EXPECT_THAT(Refusal(Changed("/accessors/1/type", "VEC2")), HasSubstr("no indices"));
  EXPECT_THAT(Refusal(Changed("/scene", 4)), HasSubstr("its scene is not there"));
  EXPECT_THAT(Refusal(Changed("/nodes", json::array({{{"name", "empty"}}}))),
              HasSubstr("no triangles in its scene"));
}

TEST(GltfFile, IsRefusedWhereItIsNotAllInOneFile) {
  json document = testing::GltfDocument(testing::Tetrahedron());
  document["buffers"][0]["uri"] = "chair.bin";
  EXPECT_THAT(Refusal(document.dump(), "chair.gltf"),
              HasSubstr("buffers[0] is in another file, \"chair.bin\"; save it as GLB"));
  document["buffers"][0]["uri"] = "data:;base64,####";
  EXPECT_THAT(Refusal(document.dump()), HasSubstr("no base64"));
  document["buffers"][0].erase("uri");
  EXPECT_THAT(Refusal(document.dump()), HasSubstr("buffers[0] has no data"));
}

TEST(GltfFile, IsRefusedWhereItIsOfAnotherKind) {
  EXPECT_THAT(Refusal(Changed("/asset/version", "1.0")), HasSubstr("another version than 2"));
  EXPECT_THAT(Refusal(Changed("/extensionsRequired", {"KHR_draco_mesh_compression"})),
              HasSubstr("KHR_draco_mesh_compression, which is not read"));
  EXPECT_THAT(Refusal("{\"chair\": 4}", "a.gltf"), HasSubstr("is JSON, but no glTF"));
  EXPECT_THAT(Refusal("{\"asset\": ", "a.gltf"), HasSubstr("its JSON cannot be read"));
  std::string glb = testing::WriteGlb(testing::Tetrahedron());
  EXPECT_THAT(Refusal(glb.substr(0, 15)), HasSubstr("ends in its header"));
  EXPECT_THAT(Refusal(glb.substr(0, glb.size() - 8)), HasSubstr("has a chunk of 96 bytes"));
  glb[4] = 1;
  EXPECT_THAT(Refusal(glb), HasSubstr("another version than 2"));
  glb[4] = 2;
  glb.replace(12, 4, "\xF0\xFF\xFF\xFF");
  EXPECT_THAT(Refusal(glb), HasSubstr("has a chunk of 4294967280 bytes"));
}

}  // namespace
}  // namespace mortise::mesh
