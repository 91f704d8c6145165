// Mesh files as other programs write them, and surfaces to put into them.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace mortise::testing {

// Points and triangles, in single precision as the formats mostly have them.
struct PlainMesh {
  Eigen::Matrix3Xf points;     // 3 × V
  Eigen::Matrix3Xi triangles;  // 3 × T
};

// A tetrahedron with corners at the origin and at 1 on each axis, its triangles seen from outside.
PlainMesh Tetrahedron();

// A wavy sheet of `cells` × `cells` squares of two triangles each, 1 across.
PlainMesh Sheet(int cells);

std::string WriteObj(const PlainMesh& mesh);
std::string WriteOff(const PlainMesh& mesh);
std::string WriteTextPly(const PlainMesh& mesh);
std::string WriteBinaryPly(const PlainMesh& mesh, bool is_big_endian = false);
std::string WriteTextStl(const PlainMesh& mesh, const std::string& name);
std::string WriteBinaryStl(const PlainMesh& mesh);

// The document of a glTF with one node of one mesh, whose buffer has `GltfBuffer`.
nlohmann::json GltfDocument(const PlainMesh& mesh);
// The points, and the corners behind them.
std::string GltfBuffer(const PlainMesh& mesh);
// A GLB of a document and the bytes of its buffer.
std::string PackGlb(const nlohmann::json& document, std::string_view buffer);
// The same as a document that has its buffer in it.
std::string PackGltf(nlohmann::json document, std::string_view buffer);
std::string WriteGlb(const PlainMesh& mesh);

}  // namespace mortise::testing
