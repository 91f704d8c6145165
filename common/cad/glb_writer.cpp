// Fills a glTF model and lets tinygltf write the container.
#include "common/cad/glb_writer.h"

#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <cmath>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cad {
namespace {

// Corners of every triangle with the triangle's normal: flat shading needs its own corners.
struct FlatTriangles {
  std::vector<float> positions;  // 3 a corner
  std::vector<float> normals;
  Eigen::Vector3f minimum = Eigen::Vector3f::Constant(INFINITY);
  Eigen::Vector3f maximum = Eigen::Vector3f::Constant(-INFINITY);
};

absl::StatusOr<FlatTriangles> Flatten(const mesh::SurfaceMesh& surface, const std::string& field) {
  if (surface.triangles.cols() == 0) return InvalidField(field, "has no triangles");
  if (!surface.vertices.allFinite()) return InvalidField(field, "is not finite");
  if (surface.triangles.minCoeff() < 0 || surface.triangles.maxCoeff() >= surface.vertices.cols()) {
    return InvalidField(field, "refers to a vertex that does not exist");
  }
  FlatTriangles flat;
  for (const auto& triangle : surface.triangles.colwise()) {
    const Eigen::Vector3d a = surface.vertices.col(triangle(0));
    const Eigen::Vector3d b = surface.vertices.col(triangle(1));
    const Eigen::Vector3d c = surface.vertices.col(triangle(2));
    const Eigen::Vector3f normal = (b - a).cross(c - a).normalized().cast<float>();
    for (const Eigen::Vector3d& corner : {a, b, c}) {
      const Eigen::Vector3f position = corner.cast<float>();
      flat.positions.insert(flat.positions.end(), position.begin(), position.end());
      flat.normals.insert(flat.normals.end(), normal.begin(), normal.end());
      flat.minimum = flat.minimum.cwiseMin(position);
      flat.maximum = flat.maximum.cwiseMax(position);
    }
  }
  return flat;
}

// Appends numbers to the model's one buffer and describes them; returns the accessor's index.
int AddAccessor(tinygltf::Model& model, const std::vector<float>& numbers) {
  std::vector<unsigned char>& bytes = model.buffers[0].data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = bytes.size();
  view.byteLength = numbers.size() * sizeof(float);
  view.target = TINYGLTF_TARGET_ARRAY_BUFFER;
  const auto* begin = reinterpret_cast<const unsigned char*>(numbers.data());
  bytes.insert(bytes.end(), begin, begin + view.byteLength);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size());
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
  accessor.type = TINYGLTF_TYPE_VEC3;
  accessor.count = numbers.size() / 3;
  model.bufferViews.push_back(std::move(view));
  model.accessors.push_back(std::move(accessor));
  return static_cast<int>(model.accessors.size()) - 1;
}

void AddPart(tinygltf::Model& model, const GlbPart& part, const FlatTriangles& flat) {
  tinygltf::Material material;
  material.name = part.name;
  material.pbrMetallicRoughness.baseColorFactor = {part.color.x(), part.color.y(), part.color.z(),
                                                   1.0};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.8;
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = static_cast<int>(model.materials.size());
  const int positions = AddAccessor(model, flat.positions);
  tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(positions)];
  accessor.minValues = {flat.minimum.x(), flat.minimum.y(), flat.minimum.z()};
  accessor.maxValues = {flat.maximum.x(), flat.maximum.y(), flat.maximum.z()};
  primitive.attributes["POSITION"] = positions;
  primitive.attributes["NORMAL"] = AddAccessor(model, flat.normals);
  tinygltf::Mesh mesh;
  mesh.name = part.name;
  mesh.primitives.push_back(std::move(primitive));
  tinygltf::Node node;
  node.name = part.name;
  node.mesh = static_cast<int>(model.meshes.size());
  model.materials.push_back(std::move(material));
  model.meshes.push_back(std::move(mesh));
  model.nodes[0].children.push_back(static_cast<int>(model.nodes.size()));
  model.nodes.push_back(std::move(node));
}

}  // namespace

absl::StatusOr<std::string> WriteGlb(const std::string& assembly_name,
                                     const std::vector<GlbPart>& parts) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "Mortise";
  model.buffers.emplace_back();
  tinygltf::Node root;
  root.name = assembly_name;
  // A quarter turn about x takes z, our upwards, to y.
  root.rotation = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  model.nodes.push_back(std::move(root));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(const FlatTriangles flat,
                             Flatten(parts[i].surface, absl::StrCat("parts[", i, "].surface")));
    AddPart(model, parts[i], flat);
  }
  if (parts.empty()) return InvalidField("parts", "is empty");
  tinygltf::Scene scene;
  scene.name = assembly_name;
  scene.nodes = {0};
  model.scenes.push_back(std::move(scene));
  model.defaultScene = 0;
  std::ostringstream stream(std::ios::binary);
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true)) {
    return WithDetail(absl::InternalError("writing GLB failed"), {"CAD_FAILED", "writing GLB"});
  }
  return stream.str();
}

}  // namespace mortise::cad
