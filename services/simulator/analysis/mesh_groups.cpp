#include "services/simulator/analysis/mesh_groups.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/mesh/element_faces.h"

namespace mortise::simulator {
namespace {

template <typename Group>
const Group* Find(const std::vector<Group>& groups, const std::string& name) {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [&](const Group& group) { return group.name == name; });
  return found == groups.end() ? nullptr : &*found;
}

// "there is no group of faces 'tpo'; did you mean 'top'?" or all names, where none is similar.
absl::Status UnknownGroup(const std::string& name, const char* kind,
                          const std::vector<std::string>& names, const std::string& field) {
  const std::string unknown = absl::StrCat("there is no group of ", kind, " '", name, "'");
  if (names.empty()) return InvalidField(field, absl::StrCat(unknown, "; the mesh has none"));
  return InvalidField(field, absl::StrCat(unknown, NamesOffered(name, names)));
}

absl::Status EmptyGroup(const std::string& name, const char* kind, const std::string& field) {
  return InvalidField(field, absl::StrCat("the group of ", kind, " '", name, "' is empty"));
}

template <typename Group>
void AddNames(const std::vector<Group>& groups, std::vector<std::string>& names) {
  for (const Group& group : groups) names.push_back(group.name);
}

std::string At(const std::string& field, std::size_t i) {
  return absl::StrCat(field, ".groups[", i, "]");
}

template <typename T>
void SortAndUnite(std::vector<T>& members) {
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
}

}  // namespace

absl::StatusOr<std::vector<int>> MeshGroups::Elements(const Names& names,
                                                      const std::string& field) const {
  std::vector<int> elements;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const mesh::ElementGroup* group = Find(mesh_.element_groups, names[i]);
    if (group == nullptr) {
      std::vector<std::string> known;
      AddNames(mesh_.element_groups, known);
      return UnknownGroup(names[i], "elements", known, At(field, i));
    }
    if (group->members.empty()) return EmptyGroup(names[i], "elements", At(field, i));
    elements.insert(elements.end(), group->members.begin(), group->members.end());
  }
  SortAndUnite(elements);
  return elements;
}

absl::StatusOr<std::vector<int>> MeshGroups::Nodes(const Names& names,
                                                   const std::string& field) const {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const mesh::FaceGroup* faces = Find(mesh_.face_groups, names[i]);
    const mesh::NodeGroup* own = Find(mesh_.node_groups, names[i]);
    if (faces == nullptr && own == nullptr) {
      std::vector<std::string> known;
      AddNames(mesh_.face_groups, known);
      AddNames(mesh_.node_groups, known);
      return UnknownGroup(names[i], "faces or nodes", known, At(field, i));
    }
    const std::size_t before = nodes.size();
    if (faces != nullptr) {
      for (const mesh::ElementSide& side : faces->members) {
        for (const int node : mesh::SideNodes(mesh_.tetrahedra, side)) nodes.push_back(node);
      }
    } else {
      nodes.insert(nodes.end(), own->members.begin(), own->members.end());
    }
    if (nodes.size() == before) {
      return EmptyGroup(names[i], faces != nullptr ? "faces" : "nodes", At(field, i));
    }
  }
  SortAndUnite(nodes);
  return nodes;
}

absl::StatusOr<std::vector<int>> MeshGroups::OwnNodes(const Names& names,
                                                      const std::string& field) const {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (Find(mesh_.node_groups, names[i]) != nullptr) continue;
    if (Find(mesh_.face_groups, names[i]) != nullptr) {
      return InvalidField(At(field, i), absl::StrCat("'", names[i],
                                                     "' is a group of faces; a group of nodes is "
                                                     "wanted here"));
    }
    std::vector<std::string> known;
    AddNames(mesh_.node_groups, known);
    return UnknownGroup(names[i], "nodes", known, At(field, i));
  }
  std::vector<int> nodes;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::vector<int>& members = Find(mesh_.node_groups, names[i])->members;
    if (members.empty()) return EmptyGroup(names[i], "nodes", At(field, i));
    nodes.insert(nodes.end(), members.begin(), members.end());
  }
  SortAndUnite(nodes);
  return nodes;
}

absl::StatusOr<mesh::NamedFace> MeshGroups::Face(const Names& names, bool is_loaded,
                                                 const std::string& field) {
  std::vector<mesh::ElementSide> sides;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const mesh::FaceGroup* group = Find(mesh_.face_groups, names[i]);
    if (group == nullptr && Find(mesh_.node_groups, names[i]) != nullptr) {
      return InvalidField(At(field, i), absl::StrCat("'", names[i],
                                                     "' is a group of nodes; a group of faces is "
                                                     "wanted here"));
    }
    if (group == nullptr) {
      std::vector<std::string> known;
      AddNames(mesh_.face_groups, known);
      return UnknownGroup(names[i], "faces", known, At(field, i));
    }
    if (group->members.empty()) return EmptyGroup(names[i], "faces", At(field, i));
    sides.insert(sides.end(), group->members.begin(), group->members.end());
  }
  SortAndUnite(sides);
  FindNeighbours();
  // A face between two elements may be in two groups, once from either side.
  std::erase_if(sides, [&](const mesh::ElementSide& side) {
    const int beyond = neighbours_[side.element][side.side];
    if (beyond < 0 || beyond > side.element) return false;
    for (int other = 0; other < 4; ++other) {
      if (neighbours_[beyond][other] == side.element &&
          std::binary_search(sides.begin(), sides.end(), mesh::ElementSide{beyond, other})) {
        return true;
      }
    }
    return false;
  });
  const bool is_outside =
      std::any_of(sides.begin(), sides.end(), [&](const auto& side) { return IsOuter(side); });
  if (is_loaded && !is_outside) {
    return InvalidField(At(field, 0), absl::StrCat("the faces of '", absl::StrJoin(names, "', '"),
                                                   "' lie between elements: nothing can act on "
                                                   "them there"));
  }
  const std::string name = absl::StrJoin(names, "', '");
  faces_.emplace(name, std::move(sides));
  return mesh::NamedFace{0, name};
}

bool MeshGroups::IsOuter(const mesh::ElementSide& side) {
  return neighbours_[side.element][side.side] < 0;
}

void MeshGroups::FindNeighbours() {
  if (!neighbours_.empty()) return;
  struct Side {
    std::array<int, 3> key;
    int element, side;
  };
  std::vector<Side> sides;
  sides.reserve(4 * static_cast<std::size_t>(mesh_.tetrahedra.cols()));
  for (int e = 0; e < mesh_.tetrahedra.cols(); ++e) {
    for (int s = 0; s < 4; ++s) {
      Side side{{}, e, s};
      for (int k = 0; k < 3; ++k) {
        side.key[k] = mesh_.tetrahedra(mesh::kTetrahedronFaces[s][k], e);
      }
      std::sort(side.key.begin(), side.key.end());
      sides.push_back(side);
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.key != b.key ? a.key < b.key : a.element < b.element;
  });
  neighbours_.assign(mesh_.tetrahedra.cols(), {-1, -1, -1, -1});
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].key != sides[i - 1].key) continue;
    neighbours_[sides[i].element][sides[i].side] = sides[i - 1].element;
    neighbours_[sides[i - 1].element][sides[i - 1].side] = sides[i].element;
  }
}

void MeshGroups::TakeFaces(mesh::TetrahedralMesh& volume) const {
  // Which of the faces each side is on.
  std::map<mesh::ElementSide, std::vector<int>> of_side;
  std::vector<std::string> names;
  for (const auto& [name, sides] : faces_) {
    for (const mesh::ElementSide& side : sides) {
      of_side[side].push_back(static_cast<int>(names.size()));
    }
    names.push_back(name);
  }
  // Sides with the same parts and the same names make one face of the mesh.
  std::map<std::tuple<int, int, std::vector<int>>, int> index;
  volume.face_triangles.resize(volume.IsQuadratic() ? 6 : 3, of_side.size());
  volume.face_triangle_face.resize(of_side.size());
  Eigen::Index t = 0;
  for (const auto& [side, on] : of_side) {
    const int beyond = neighbours_[side.element][side.side];
    const int back = volume.part[side.element], front = beyond < 0 ? -1 : volume.part[beyond];
    const auto [found, is_new] =
        index.try_emplace({front, back, on}, static_cast<int>(volume.faces.size()));
    if (is_new) {
      mesh::AssemblyFace face{front, back, {}};
      for (const int name : on) face.origins.push_back({0, names[name]});
      volume.faces.push_back(std::move(face));
    }
    volume.face_triangles.col(t) = mesh::SideNodes(mesh_.tetrahedra, side);
    volume.face_triangle_face[t++] = found->second;
  }
}

}  // namespace mortise::simulator
