#include "tests/support/scene_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace mortise::testing {
namespace {

template <typename Number>
void Append(Number number, std::string& bytes, bool is_big_endian = false) {
  char piece[sizeof number];
  std::memcpy(piece, &number, sizeof number);
  if (is_big_endian) std::reverse(piece, piece + sizeof number);
  bytes.append(piece, sizeof number);
}

std::string Words(const Eigen::Vector3f& point) {
  return absl::StrCat(point.x(), " ", point.y(), " ", point.z());
}

std::string PlyHeaderOf(const PlainMesh& mesh, const char* format) {
  return absl::StrCat(
      "ply\nformat ", format, " 1.0\ncomment made by hand\nelement vertex ", mesh.points.cols(),
      "\nproperty float x\nproperty float y\nproperty float z\nelement face ",
      mesh.triangles.cols(), "\nproperty list uchar int vertex_indices\n", "end_header\n");
}

}  // namespace

PlainMesh Tetrahedron() {
  PlainMesh mesh;
  mesh.points.resize(3, 4);
  mesh.points << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.triangles.resize(3, 4);
  mesh.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  return mesh;
}

PlainMesh Sheet(int cells) {
  PlainMesh mesh;
  const int side = cells + 1;
  mesh.points.resize(3, side * side);
  mesh.triangles.resize(3, 2 * cells * cells);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const float x = static_cast<float>(i) / static_cast<float>(cells);
      const float y = static_cast<float>(j) / static_cast<float>(cells);
      mesh.points.col(i * side + j) << x, y, 0.1f * std::sin(9 * x) * std::cos(7 * y);
    }
  }
  for (int i = 0, t = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      const int a = i * side + j, b = a + side;
      mesh.triangles.col(t++) << a, b, a + 1;
      mesh.triangles.col(t++) << b, b + 1, a + 1;
    }
  }
  return mesh;
}

std::string WriteObj(const PlainMesh& mesh) {
  std::string text;
  for (const auto& point : mesh.points.colwise()) absl::StrAppend(&text, "v ", Words(point), "\n");
  for (const auto& corners : mesh.triangles.colwise()) {
    absl::StrAppend(&text, "f ", corners(0) + 1, " ", corners(1) + 1, " ", corners(2) + 1, "\n");
  }
  return text;
}

std::string WriteOff(const PlainMesh& mesh) {
  std::string text = absl::StrCat("OFF\n", mesh.points.cols(), " ", mesh.triangles.cols(), " 0\n");
  for (const auto& point : mesh.points.colwise()) absl::StrAppend(&text, Words(point), "\n");
  for (const auto& corners : mesh.triangles.colwise()) {
    absl::StrAppend(&text, "3 ", corners(0), " ", corners(1), " ", corners(2), "\n");
  }
  return text;
}

std::string WriteTextPly(const PlainMesh& mesh) {
  std::string text = PlyHeaderOf(mesh, "ascii");
  for (const auto& point : mesh.points.colwise()) absl::StrAppend(&text, Words(point), "\n");
  for (const auto& corners : mesh.triangles.colwise()) {
    absl::StrAppend(&text, "3 ", corners(0), " ", corners(1), " ", corners(2), "\n");
  }
  return text;
}

std::string WriteBinaryPly(const PlainMesh& mesh, bool is_big_endian) {
  std::string bytes =
      PlyHeaderOf(mesh, is_big_endian ? "binary_big_endian" : "binary_little_endian");
  for (const float number : mesh.points.reshaped()) Append(number, bytes, is_big_endian);
  for (const auto& corners : mesh.triangles.colwise()) {
    bytes += '\3';
    for (const int corner : corners) Append(corner, bytes, is_big_endian);
  }
  return bytes;
}

std::string WriteTextStl(const PlainMesh& mesh, const std::string& name) {
  std::string text = absl::StrCat("solid ", name, "\n");
  for (const auto& corners : mesh.triangles.colwise()) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (const int corner : corners) {
      absl::StrAppend(&text, "      vertex ", Words(mesh.points.col(corner)), "\n");
    }
    text += "    endloop\n  endfacet\n";
  }
  return absl::StrCat(text, "endsolid ", name, "\n");
}

std::string WriteBinaryStl(const PlainMesh& mesh) {
  std::string bytes(80, ' ');
  Append(static_cast<std::uint32_t>(mesh.triangles.cols()), bytes);
  for (const auto& corners : mesh.triangles.colwise()) {
    bytes.append(12, '\0');
    for (const int corner : corners) {
      for (const float number : mesh.points.col(corner)) Append(number, bytes);
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

nlohmann::json GltfDocument(const PlainMesh& mesh) {
  const Eigen::Index points = 12 * mesh.points.cols(), corners = 12 * mesh.triangles.cols();
  nlohmann::json document = nlohmann::json::parse(R"({
      "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"name": "thing", "mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]})");
  document["buffers"] = {{{"byteLength", points + corners}}};
  document["bufferViews"] = {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", points}},
                             {{"buffer", 0}, {"byteOffset", points}, {"byteLength", corners}}};
  document["accessors"] = {
      {{"bufferView", 0}, {"componentType", 5126}, {"type", "VEC3"}, {"count", mesh.points.cols()}},
      {{"bufferView", 1},
       {"componentType", 5125},
       {"type", "SCALAR"},
       {"count", 3 * mesh.triangles.cols()}}};
  return document;
}

std::string GltfBuffer(const PlainMesh& mesh) {
  std::string bytes;
  for (const float number : mesh.points.reshaped()) Append(number, bytes);
  for (const int corner : mesh.triangles.reshaped()) Append(corner, bytes);
  return bytes;
}

std::string PackGlb(const nlohmann::json& document, std::string_view buffer) {
  std::string json = document.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF";
  Append(std::uint32_t{2}, glb);
  Append(static_cast<std::uint32_t>(28 + json.size() + buffer.size()), glb);
  Append(static_cast<std::uint32_t>(json.size()), glb);
  glb.append("JSON").append(json);
  Append(static_cast<std::uint32_t>(buffer.size()), glb);
  return glb.append("BIN\0", 4).append(buffer);
}

std::string PackGltf(nlohmann::json document, std::string_view buffer) {
  document["buffers"][0]["uri"] = absl::StrCat("data:application/octet-stream;base64,",
                                               absl::Base64Escape({buffer.data(), buffer.size()}));
  return document.dump();
}

std::string WriteGlb(const PlainMesh& mesh) {
  return PackGlb(GltfDocument(mesh), GltfBuffer(mesh));
}

}  // namespace mortise::testing
