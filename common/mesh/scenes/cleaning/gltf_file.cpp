// glTF 2.0: the nodes, meshes and buffers of its scene. Materials, pictures, bones, shape keys,
// cameras, lights and animations are passed over.
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/scenes/cleaning/cleaned_file.h"
#include "common/mesh/scenes/cleaning/gltf_container.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"

namespace mortise::mesh {
namespace {

using nlohmann::json;

constexpr std::uint64_t kNone = UINT64_MAX;
constexpr std::uint64_t kFloat = 5126;
constexpr std::uint64_t kTriangles = 4, kStrip = 5, kFan = 6;  // modes of primitives
constexpr std::uint64_t kMaxAccessorCount = 3 * kMaxSceneTriangles;

// Extensions that hide triangles from whoever does not know them.
constexpr std::array<const char*, 4> kUnreadExtensions = {
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing"};

absl::Status Damaged(const std::string& what) {
  return InvalidField("file", absl::StrCat("is damaged: ", what));
}

// The bytes of a component of an accessor; 0 for a type that glTF does not have.
std::uint64_t ComponentSize(std::uint64_t type) {
  if (type == 5120 || type == 5121) return 1;
  if (type == 5122 || type == 5123) return 2;
  return type == 5125 || type == kFloat ? 4 : 0;
}

// Writes the part of a document that makes a surface, in an order of its own, and refuses what it
// would read out of bounds or without end.
class GltfCleaning {
 public:
  explicit GltfCleaning(GltfContainer container) : in_(std::move(container)) {}

  absl::StatusOr<CleanedFile> Clean() && {
    MORTISE_RETURN_IF_ERROR(CheckExtensions());
    MORTISE_RETURN_IF_ERROR(AddViews());
    MORTISE_ASSIGN_OR_RETURN(const std::vector<std::uint64_t> roots, Roots());
    json root_indices = json::array();
    for (const std::uint64_t root : roots) {
      MORTISE_RETURN_IF_ERROR(Visit(root, root_indices));
    }
    MORTISE_RETURN_IF_ERROR(AddWaiting());
    if (triangles_ == 0) return InvalidField("file", "has no triangles in its scene");
    out_["asset"] = {{"version", "2.0"}};
    out_["scene"] = 0;
    out_["scenes"] = json::array({{{"nodes", root_indices}}});
    out_["buffers"] = json::array({{{"byteLength", in_.data.size()}}});
    CleanedFile cleaned;
    cleaned.extension = "glb";
    cleaned.bytes = WriteGlb(out_, in_.data);
    cleaned.names = std::move(names_);
    if (passed_over_ > 0) {
      cleaned.notes.push_back(
          absl::StrCat("Meshes of points or lines, left out: ", passed_over_, "."));
    }
    if (!GltfArray(in_.document, "skins").empty()) {
      cleaned.notes.push_back("Bones were left out: the surface is as it was before they bend it.");
    }
    return cleaned;
  }

 private:
  // A node whose children wait to be added: its place in the output, and how deep it lies.
  struct Waiting {
    std::uint64_t node;
    std::size_t place;
    int depth;
  };

  absl::Status CheckExtensions() const {
    for (const json& name : GltfArray(in_.document, "extensionsRequired")) {
      for (const char* unread : kUnreadExtensions) {
        if (name == unread) {
          return InvalidField(
              "file", absl::StrCat("needs ", unread, ", which is not read; save it without"));
        }
      }
    }
    return absl::OkStatus();
  }

  absl::Status AddViews() {
    const json& views = GltfArray(in_.document, "bufferViews");
    json& out = out_["bufferViews"] = json::array();
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!views[i].is_object()) return Damaged("a buffer view is no object");
      MORTISE_ASSIGN_OR_RETURN(const auto buffer, GltfNumber(views[i], "buffer", kNone));
      MORTISE_ASSIGN_OR_RETURN(const auto offset, GltfNumber(views[i], "byteOffset", 0));
      MORTISE_ASSIGN_OR_RETURN(const auto length, GltfNumber(views[i], "byteLength", 0));
      MORTISE_ASSIGN_OR_RETURN(const auto stride, GltfNumber(views[i], "byteStride", 0));
      if (buffer >= in_.length.size() || offset + length > in_.length[buffer]) {
        return InvalidField("file", absl::StrCat("bufferViews[", i, "] reaches beyond its buffer"));
      }
      out.push_back(
          {{"buffer", 0}, {"byteOffset", in_.offset[buffer] + offset}, {"byteLength", length}});
      if (stride > 0) out.back()["byteStride"] = stride;
    }
    return absl::OkStatus();
  }

  // The topmost nodes of the scene that is shown, or of the first; of all, where there is none.
  absl::StatusOr<std::vector<std::uint64_t>> Roots() {
    const json& nodes = GltfArray(in_.document, "nodes");
    parent_.assign(nodes.size(), kNone);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (const json& child : GltfArray(nodes[i], "children")) {
        if (!child.is_number_unsigned() || child.get<std::uint64_t>() >= nodes.size()) {
          return Damaged(absl::StrCat("nodes[", i, "] has a child that is not there"));
        }
        std::uint64_t& parent = parent_[child.get<std::uint64_t>()];
        if (parent != kNone) {
          return Damaged(
              absl::StrCat("nodes[", child.get<std::uint64_t>(), "] is in several nodes"));
        }
        parent = i;
      }
    }
    const json& scenes = GltfArray(in_.document, "scenes");
    std::vector<std::uint64_t> roots;
    if (scenes.empty()) {
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (parent_[i] == kNone) roots.push_back(i);
      }
      if (roots.empty() && !nodes.empty()) return Damaged("its nodes contain each other");
      return roots;
    }
    MORTISE_ASSIGN_OR_RETURN(const auto shown, GltfNumber(in_.document, "scene", 0));
    if (shown >= scenes.size()) return Damaged("its scene is not there");
    for (const json& root : GltfArray(scenes[shown], "nodes")) {
      if (!root.is_number_unsigned() || root.get<std::uint64_t>() >= nodes.size()) {
        return Damaged("its scene has a node that is not there");
      }
      roots.push_back(root.get<std::uint64_t>());
    }
    return roots;
  }

  absl::Status Visit(std::uint64_t root, json& root_indices) {
    if (parent_[root] != kNone) {
      // Every node has one parent at most, so only a node that is within another, or within
      // itself, comes here.
      return Damaged(absl::StrCat("nodes[", root, "] is of the scene and within a node"));
    }
    if (is_root_.contains(root)) return Damaged(absl::StrCat("nodes[", root, "] is there twice"));
    is_root_[root] = true;
    root_indices.push_back(out_["nodes"].size());
    return AddNode(root, 1);
  }

  absl::Status AddNode(std::uint64_t node, int depth) {
    if (depth > kMaxSceneDepth) {
      return InvalidField(
          "file", absl::StrCat("has nodes more than ", kMaxSceneDepth, " deep in each other"));
    }
    const json& in = GltfArray(in_.document, "nodes")[node];
    if (!in.is_object()) return Damaged("a node is no object");
    json out = json::object();
    for (const auto& [key, size] :
         {std::pair{"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}}) {
      const json& numbers = GltfArray(in, key);
      if (numbers.empty()) continue;
      if (static_cast<int>(numbers.size()) != size ||
          !std::all_of(numbers.begin(), numbers.end(),
                       [](const json& n) { return n.is_number(); })) {
        return Damaged(absl::StrCat("nodes[", node, "].", key, " has not ", size, " numbers"));
      }
      out[key] = numbers;
    }
    MORTISE_ASSIGN_OR_RETURN(const auto mesh, GltfNumber(in, "mesh", kNone));
    if (mesh != kNone) {
      MORTISE_ASSIGN_OR_RETURN(const std::optional<std::size_t> place, MeshPlace(mesh));
      if (place) {
        out["mesh"] = *place;
        out["name"] = absl::StrCat("c", names_.size());
        names_.push_back(NameOf(in, GltfArray(in_.document, "meshes")[mesh]));
        triangles_ += mesh_triangles_[*place];
        if (triangles_ > kMaxSceneTriangles) return TooLarge("file", "2,000,000 triangles");
      }
    }
    json& nodes = out_["nodes"];
    waiting_.push_back({node, nodes.size(), depth});
    nodes.push_back(std::move(out));
    return absl::OkStatus();
  }

  // Adds the children of nodes that wait, their children, and so on.
  absl::Status AddWaiting() {
    while (!waiting_.empty()) {
      const Waiting waiting = waiting_.back();
      waiting_.pop_back();
      const json& children = GltfArray(GltfArray(in_.document, "nodes")[waiting.node], "children");
      for (const json& child : children) {
        out_["nodes"][waiting.place]["children"].push_back(out_["nodes"].size());
        MORTISE_RETURN_IF_ERROR(AddNode(child.get<std::uint64_t>(), waiting.depth + 1));
      }
    }
    return absl::OkStatus();
  }

  static std::string NameOf(const json& node, const json& mesh) {
    for (const json* named : {&node, &mesh}) {
      const auto name = named->find("name");
      if (name != named->end() && name->is_string() &&
          !name->get_ref<const std::string&>().empty()) {
        return *name;
      }
    }
    return "";
  }

  // The place of a mesh in the output, where it is added at its first use; nothing if it has no
  // triangles.
  absl::StatusOr<std::optional<std::size_t>> MeshPlace(std::uint64_t mesh) {
    const auto [entry, is_new] = place_of_.try_emplace(mesh, std::nullopt);
    if (!is_new) return entry->second;
    const json& meshes = GltfArray(in_.document, "meshes");
    if (mesh >= meshes.size() || !meshes[mesh].is_object()) {
      return Damaged(absl::StrCat("meshes[", mesh, "] is not there"));
    }
    json primitives = json::array();
    std::int64_t triangles = 0;
    for (const json& primitive : GltfArray(meshes[mesh], "primitives")) {
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t count, AddPrimitive(primitive, primitives));
      triangles += count;
    }
    if (primitives.empty()) return entry->second;
    json& out = out_["meshes"];
    entry->second = out.size();
    out.push_back({{"primitives", std::move(primitives)}});
    mesh_triangles_.push_back(triangles);
    return entry->second;
  }

  // Adds one piece of a mesh, and gives its number of triangles.
  absl::StatusOr<std::int64_t> AddPrimitive(const json& primitive, json& primitives) {
    if (!primitive.is_object()) return Damaged("a primitive is no object");
    MORTISE_ASSIGN_OR_RETURN(const auto mode, GltfNumber(primitive, "mode", kTriangles));
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) {
      return Damaged("a primitive has no attributes");
    }
    MORTISE_ASSIGN_OR_RETURN(const auto position, GltfNumber(*attributes, "POSITION", kNone));
    if (position == kNone || (mode != kTriangles && mode != kStrip && mode != kFan)) {
      ++passed_over_;
      return 0;
    }
    MORTISE_ASSIGN_OR_RETURN(const Accessor points, AddAccessor(position, false));
    json out = {{"mode", mode}, {"attributes", {{"POSITION", points.place}}}};
    std::uint64_t count = points.count;
    MORTISE_ASSIGN_OR_RETURN(const auto indices, GltfNumber(primitive, "indices", kNone));
    if (indices != kNone) {
      MORTISE_ASSIGN_OR_RETURN(const Accessor corners, AddAccessor(indices, true));
      out["indices"] = corners.place;
      count = corners.count;
    }
    if (count < 3) return 0;
    primitives.push_back(std::move(out));
    return static_cast<std::int64_t>(mode == kTriangles ? count / 3 : count - 2);
  }

  struct Accessor {
    std::size_t place;
    std::uint64_t count;
  };

  // Adds the accessor of positions or of indices.
  absl::StatusOr<Accessor> AddAccessor(std::uint64_t index, bool is_indices) {
    const json& accessors = GltfArray(in_.document, "accessors");
    const std::string which = absl::StrCat("accessors[", index, "] ");
    if (index >= accessors.size() || !accessors[index].is_object()) {
      return Damaged(absl::StrCat(which, "is not there"));
    }
    const json& in = accessors[index];
    MORTISE_ASSIGN_OR_RETURN(const auto count, GltfNumber(in, "count", 0));
    MORTISE_ASSIGN_OR_RETURN(const auto type, GltfNumber(in, "componentType", 0));
    const std::string kind = in.value("type", json("")).is_string() ? in.value("type", "") : "";
    if (is_indices ? kind != "SCALAR" || (type != 5121 && type != 5123 && type != 5125)
                   : kind != "VEC3" || type != kFloat) {
      return InvalidField("file", absl::StrCat(which, is_indices ? "holds no indices of vertices"
                                                                 : "holds positions that are not "
                                                                   "three floats each"));
    }
    if (count == 0) return Damaged(absl::StrCat(which, "is empty"));
    if (count > kMaxAccessorCount) return TooLarge("file", "2,000,000 triangles");
    const std::uint64_t size = ComponentSize(type) * (is_indices ? 1 : 3);
    json out = {{"componentType", type}, {"type", kind}, {"count", count}};
    if (in.contains("bufferView")) {
      MORTISE_RETURN_IF_ERROR(AddRange(in, count, size, which, out));
    } else if (!in.contains("sparse")) {
      return Damaged(absl::StrCat(which, "has no data"));
    }
    if (in.contains("sparse")) {
      MORTISE_RETURN_IF_ERROR(AddSparse(in["sparse"], count, size, which, out));
    }
    json& all = out_["accessors"];
    all.push_back(std::move(out));
    return Accessor{all.size() - 1, count};
  }

  // Copies where an accessor's data are, `count` of `size` bytes, if the view holds them all.
  absl::Status AddRange(const json& in, std::uint64_t count, std::uint64_t size,
                        const std::string& which, json& out) {
    MORTISE_ASSIGN_OR_RETURN(const auto view, GltfNumber(in, "bufferView", kNone));
    MORTISE_ASSIGN_OR_RETURN(const auto offset, GltfNumber(in, "byteOffset", 0));
    const json& views = out_["bufferViews"];
    if (view >= views.size()) return Damaged(absl::StrCat(which, "has a view that is not there"));
    const std::uint64_t stride =
        std::max<std::uint64_t>(views[view].value("byteStride", size), size);
    const std::uint64_t length = views[view]["byteLength"];
    if (count > 0 && offset + stride * (count - 1) + size > length) {
      return InvalidField("file", absl::StrCat(which, "reaches beyond its buffer view"));
    }
    out["bufferView"] = view;
    out["byteOffset"] = offset;
    return absl::OkStatus();
  }

  absl::Status AddSparse(const json& in, std::uint64_t accessor_count, std::uint64_t size,
                         const std::string& which, json& out) {
    if (!in.is_object() || !in.contains("indices") || !in["indices"].is_object() ||
        !in.contains("values") || !in["values"].is_object()) {
      return Damaged(absl::StrCat(which, "is sparse, but not complete"));
    }
    MORTISE_ASSIGN_OR_RETURN(const auto count, GltfNumber(in, "count", 0));
    MORTISE_ASSIGN_OR_RETURN(const auto type, GltfNumber(in["indices"], "componentType", 0));
    if (count > accessor_count || (type != 5121 && type != 5123 && type != 5125)) {
      return Damaged(absl::StrCat(which, "has sparse values that are out of range"));
    }
    json indices = {{"componentType", type}};
    json values = json::object();
    MORTISE_RETURN_IF_ERROR(AddRange(in["indices"], count, ComponentSize(type), which, indices));
    MORTISE_RETURN_IF_ERROR(AddRange(in["values"], count, size, which, values));
    out["sparse"] = {{"count", count}, {"indices", indices}, {"values", values}};
    return absl::OkStatus();
  }

  const GltfContainer in_;
  json out_ = {{"nodes", json::array()}, {"meshes", json::array()}, {"accessors", json::array()}};
  std::vector<std::uint64_t> parent_;
  std::map<std::uint64_t, bool> is_root_;
  std::vector<Waiting> waiting_;
  std::map<std::uint64_t, std::optional<std::size_t>> place_of_;  // of a mesh
  std::vector<std::int64_t> mesh_triangles_;                      // of each mesh of the output
  std::vector<std::string> names_;
  std::int64_t triangles_ = 0;
  std::int64_t passed_over_ = 0;  // primitives of points and lines
};

absl::StatusOr<CleanedFile> Clean(absl::StatusOr<GltfContainer> container) {
  if (!container.ok()) return container.status();
  return GltfCleaning(*std::move(container)).Clean();
}

}  // namespace

absl::StatusOr<CleanedFile> CleanGlb(std::string_view bytes) { return Clean(OpenGlb(bytes)); }

absl::StatusOr<CleanedFile> CleanGltf(std::string_view bytes) { return Clean(OpenGltf(bytes)); }

}  // namespace mortise::mesh
