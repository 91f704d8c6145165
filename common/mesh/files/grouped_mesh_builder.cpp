#include "common/mesh/files/grouped_mesh_builder.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/element_faces.h"

namespace mortise::mesh {
namespace {

constexpr std::size_t kMaxNodes = 100'000'000;
constexpr std::size_t kMaxGroups = 10'000;   // of a kind
constexpr std::size_t kMaxNameLength = 200;  // bytes
constexpr std::size_t kListedNames = 20;     // in a note

// Of all groups together. Files may have more than the first of these only if they are so long that
// elements and nodes which are listed once each can be as many.
constexpr std::size_t kMaxMembers = 10'000'000;
constexpr std::size_t kBytesOfMember = 16;

}  // namespace

bool IsPlainText(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const auto lead = static_cast<unsigned char>(text[at]);
    if (lead < 0x20 || lead == 0x7f) return false;
    const int length = lead < 0x80                    ? 1
                       : lead >= 0xc2 && lead < 0xe0  ? 2
                       : lead >= 0xe0 && lead < 0xf0  ? 3
                       : lead >= 0xf0 && lead <= 0xf4 ? 4
                                                      : 0;
    if (length == 0 || at + length > text.size()) return false;
    char32_t code = length == 1 ? lead : lead & (0xff >> (length + 1));
    for (int k = 1; k < length; ++k) {
      const auto byte = static_cast<unsigned char>(text[at + k]);
      if ((byte & 0xc0) != 0x80) return false;
      code = (code << 6) | (byte & 0x3f);
    }
    if ((length == 3 && code < 0x800) || (length == 4 && (code < 0x10000 || code > 0x10ffff)) ||
        (code >= 0xd800 && code < 0xe000)) {
      return false;
    }
    at += length;
  }
  return true;
}

namespace {

template <typename T>
void SortAndUnite(std::vector<T>& members) {
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
}

}  // namespace

std::size_t GroupedMeshBuilder::CornersHash::operator()(const Corners& corners) const {
  std::size_t hash = 0;
  for (const int k : corners) hash = (hash ^ static_cast<unsigned>(k)) * 0x9e3779b97f4a7c15ull;
  return hash ^ (hash >> 29);
}

std::string FilePlaces::Where(std::size_t place) const {
  const std::string_view before = bytes_.substr(0, place);
  return is_text_ ? absl::StrCat("line ", 1 + std::count(before.begin(), before.end(), '\n'))
                  : absl::StrCat("byte ", place);
}

absl::Status FilePlaces::Fault(std::size_t place, std::string_view message) const {
  return InvalidField("mesh_file", absl::StrCat(Where(place), ": ",
                                                absl::string_view(message.data(), message.size())));
}

absl::Status GroupedMeshBuilder::AddNode(std::int64_t number, const Eigen::Vector3d& position,
                                         std::size_t place) {
  if (!position.allFinite()) {
    return places_.Fault(place, absl::StrCat("a coordinate of node ", number, " is not finite"));
  }
  if (nodes_.size() >= kMaxNodes) return places_.Fault(place, "there are too many nodes");
  if (!node_index_.emplace(number, static_cast<int>(nodes_.size())).second) {
    return places_.Fault(place, absl::StrCat("there is a node ", number, " already"));
  }
  nodes_.push_back(position);
  node_numbers_.push_back(number);
  return absl::OkStatus();
}

absl::Status GroupedMeshBuilder::AddElement(std::int64_t number,
                                            std::span<const std::int64_t> nodes,
                                            std::size_t place) {
  const int count = static_cast<int>(nodes.size());
  if (nodes_of_element_ == 0) nodes_of_element_ = count;
  if (nodes_of_element_ != count) {
    return places_.Fault(place, absl::StrCat("element ", number, " has ", count,
                                             " nodes, those before it have ", nodes_of_element_));
  }
  if (element_numbers_.size() >= kMaxNodes) {
    return places_.Fault(place, "there are too many elements");
  }
  if (!element_index_.emplace(number, static_cast<int>(element_numbers_.size())).second) {
    return places_.Fault(place, absl::StrCat("there is an element ", number, " already"));
  }
  element_numbers_.push_back(number);
  element_places_.push_back(place);
  element_nodes_.insert(element_nodes_.end(), nodes.begin(), nodes.end());
  return absl::OkStatus();
}

absl::StatusOr<int> GroupedMeshBuilder::AddGroup(Groups& groups, const std::string& name,
                                                 std::size_t place, Owner owner) {
  const auto found = groups.index.find({owner, name});
  if (found != groups.index.end()) return found->second;
  if (groups.groups.size() >= kMaxGroups) return places_.Fault(place, "there are too many groups");
  if (name.empty() || name.size() > kMaxNameLength || !IsPlainText(name)) {
    return places_.Fault(place, absl::StrCat("the name of a group must be 1 to ", kMaxNameLength,
                                             " bytes of UTF-8 without control characters"));
  }
  const int group = static_cast<int>(groups.groups.size());
  groups.index.emplace(std::pair(owner, name), group);
  groups.groups.push_back({owner, name, {}, {}});
  return group;
}

absl::StatusOr<int> GroupedMeshBuilder::AddNodeGroup(const std::string& name, std::size_t place,
                                                     Owner owner) {
  return AddGroup(node_groups_, name, place, owner);
}

absl::StatusOr<int> GroupedMeshBuilder::AddElementGroup(const std::string& name, std::size_t place,
                                                        Owner owner) {
  return AddGroup(element_groups_, name, place, owner);
}

absl::StatusOr<int> GroupedMeshBuilder::AddFaceGroup(const std::string& name, std::size_t place,
                                                     Owner owner) {
  return AddGroup(face_groups_, name, place, owner);
}

absl::Status GroupedMeshBuilder::SpendMember(std::size_t place) {
  const std::size_t most = kMaxMembers + places_.size() / kBytesOfMember;
  if (++members_ <= most) return absl::OkStatus();
  return places_.Fault(place, absl::StrCat("the groups have more than ", most, " members"));
}

absl::Status GroupedMeshBuilder::AddNodeMember(int group, std::int64_t number, std::size_t place) {
  MORTISE_RETURN_IF_ERROR(SpendMember(place));
  node_groups_.groups[group].members.push_back({number, place, -1});
  return absl::OkStatus();
}

absl::Status GroupedMeshBuilder::AddElementMember(int group, std::int64_t number,
                                                  std::size_t place) {
  MORTISE_RETURN_IF_ERROR(SpendMember(place));
  element_groups_.groups[group].members.push_back({number, place, -1});
  return absl::OkStatus();
}

absl::Status GroupedMeshBuilder::AddSideMember(int group, std::int64_t element, int side,
                                               std::size_t place) {
  MORTISE_RETURN_IF_ERROR(SpendMember(place));
  face_groups_.groups[group].members.push_back({element, place, side});
  return absl::OkStatus();
}

absl::Status GroupedMeshBuilder::AddTriangle(int group, const std::array<std::int64_t, 3>& corners,
                                             std::size_t place) {
  MORTISE_RETURN_IF_ERROR(SpendMember(place));
  face_groups_.groups[group].triangles.push_back({corners, place});
  return absl::OkStatus();
}

absl::Status GroupedMeshBuilder::AddLooseTriangle(const std::array<std::int64_t, 3>& corners,
                                                  std::size_t place) {
  MORTISE_RETURN_IF_ERROR(SpendMember(place));
  loose_triangles_.push_back({corners, place});
  return absl::OkStatus();
}

std::span<const std::int64_t> GroupedMeshBuilder::ElementNodes(std::int64_t number) const {
  const auto found = element_index_.find(number);
  if (found == element_index_.end()) return {};
  const auto count = static_cast<std::size_t>(nodes_of_element_);
  return std::span(element_nodes_).subspan(count * static_cast<std::size_t>(found->second), count);
}

// Afterwards names are distinct within a kind, and each kind's groups are in their order.
void GroupedMeshBuilder::NamePartGroups() {
  std::set<std::string> of_whole, taken;
  for (const Groups* const kind : {&node_groups_, &element_groups_, &face_groups_}) {
    for (const Group& group : kind->groups) {
      taken.insert(group.name);
      if (group.owner == Owner::kWhole) of_whole.insert(absl::AsciiStrToUpper(group.name));
    }
  }
  std::set<std::string> renamed;
  for (Groups* const kind : {&node_groups_, &element_groups_, &face_groups_}) {
    for (Group& group : kind->groups) {
      if (group.owner == Owner::kWhole) continue;
      if (!of_whole.contains(absl::AsciiStrToUpper(group.name))) continue;
      do {
        group.name = absl::StrCat(part_name_, ".", group.name);
      } while (taken.contains(group.name));
      renamed.insert(group.name);
    }
    std::sort(kind->groups.begin(), kind->groups.end(),
              [](const Group& a, const Group& b) { return a.name < b.name; });
  }
  if (renamed.empty()) return;
  std::string note = "sets of the part, called so because the assembly has their names too:";
  std::size_t listed = 0;
  for (const std::string& name : renamed) {
    if (listed == kListedNames) break;
    absl::StrAppend(&note, listed++ == 0 ? " " : ", ", name);
  }
  if (renamed.size() > listed) absl::StrAppend(&note, " and ", renamed.size() - listed, " more");
  AddNote(std::move(note));
}

absl::Status GroupedMeshBuilder::ResolveElements(GroupedMesh& mesh) {
  const auto elements = static_cast<Eigen::Index>(element_numbers_.size());
  mesh.tetrahedra.resize(nodes_of_element_, elements);
  for (Eigen::Index e = 0; e < elements; ++e) {
    for (int k = 0; k < nodes_of_element_; ++k) {
      const std::int64_t number = element_nodes_[e * nodes_of_element_ + k];
      const auto found = node_index_.find(number);
      if (found == node_index_.end()) {
        return places_.Fault(element_places_[e],
                             absl::StrCat("element ", element_numbers_[e], " names node ", number,
                                          ", which does not exist"));
      }
      mesh.tetrahedra(k, e) = found->second;
      for (int before = 0; before < k; ++before) {
        if (mesh.tetrahedra(before, e) != found->second) continue;
        return places_.Fault(element_places_[e], absl::StrCat("element ", element_numbers_[e],
                                                              " names node ", number, " twice"));
      }
    }
  }
  mesh.element_numbers = element_numbers_;
  return absl::OkStatus();
}

absl::Status GroupedMeshBuilder::MergeRepeats(GroupedMesh& mesh) {
  const auto elements = static_cast<int>(mesh.tetrahedra.cols());
  std::vector<std::array<int, 4>> corners(elements);
  for (int e = 0; e < elements; ++e) {
    for (int k = 0; k < 4; ++k) corners[e][k] = mesh.tetrahedra(k, e);
    std::sort(corners[e].begin(), corners[e].end());
  }
  std::vector<int> order(elements);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return corners[a] != corners[b] ? corners[a] < corners[b] : a < b;
  });
  std::vector<int> same(elements);  // the first element on the same corners
  std::iota(same.begin(), same.end(), 0);
  bool repeated = false;
  for (int i = 1; i < elements; ++i) {
    if (corners[order[i]] != corners[order[i - 1]]) continue;
    const int first = same[order[i - 1]];
    const bool is_same = mesh.tetrahedra.col(order[i]) == mesh.tetrahedra.col(first);
    if (repeats_ == Repeats::kRefused || !is_same) {
      return places_.Fault(element_places_[order[i]],
                           absl::StrCat("element ", element_numbers_[order[i]],
                                        " has the corners of element ", element_numbers_[first]));
    }
    same[order[i]] = first;
    repeated = true;
  }
  if (!repeated) return absl::OkStatus();
  std::vector<int> index(elements);
  int kept = 0;
  for (int e = 0; e < elements; ++e) {
    index[e] = same[e] == e ? kept : index[same[e]];
    if (same[e] != e) continue;
    mesh.tetrahedra.col(kept) = mesh.tetrahedra.col(e).eval();
    mesh.element_numbers[kept++] = mesh.element_numbers[e];
  }
  mesh.tetrahedra.conservativeResize(Eigen::NoChange, kept);
  mesh.element_numbers.resize(kept);
  for (auto& [number, e] : element_index_) e = index[e];
  return absl::OkStatus();
}

absl::Status GroupedMeshBuilder::ResolveElementGroups(GroupedMesh& mesh) const {
  for (const auto& [owner, name, members, triangles] : element_groups_.groups) {
    ElementGroup group{name, {}};
    for (const Member& member : members) {
      const auto found = element_index_.find(member.number);
      if (found == element_index_.end()) {
        return places_.Fault(member.place, absl::StrCat("group '", name, "' names element ",
                                                        member.number, ", which does not exist"));
      }
      group.members.push_back(found->second);
    }
    SortAndUnite(group.members);
    mesh.element_groups.push_back(std::move(group));
  }
  return absl::OkStatus();
}

absl::StatusOr<GroupedMeshBuilder::Corners> GroupedMeshBuilder::CornersOf(
    const Triangle& triangle) const {
  Corners corners{};
  for (int k = 0; k < 3; ++k) {
    const auto found = node_index_.find(triangle.corners[k]);
    if (found == node_index_.end()) {
      return places_.Fault(triangle.place, absl::StrCat("there is no node ", triangle.corners[k]));
    }
    corners[k] = found->second;
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

absl::StatusOr<GroupedMeshBuilder::SidesByCorners> GroupedMeshBuilder::FindSides(
    const GroupedMesh& mesh) const {
  SidesByCorners sides;
  for (const Group& group : face_groups_.groups) {
    for (const Triangle& triangle : group.triangles) {
      MORTISE_ASSIGN_OR_RETURN(const Corners corners, CornersOf(triangle));
      sides.try_emplace(corners, ElementSide{-1, -1});
    }
  }
  for (const Triangle& triangle : loose_triangles_) {
    MORTISE_ASSIGN_OR_RETURN(const Corners corners, CornersOf(triangle));
    sides.try_emplace(corners, ElementSide{-1, -1});
  }
  if (sides.empty()) return sides;
  for (int e = 0; e < mesh.tetrahedra.cols(); ++e) {
    for (int side = 0; side < 4; ++side) {
      Corners corners{};
      for (int k = 0; k < 3; ++k) corners[k] = mesh.tetrahedra(kTetrahedronFaces[side][k], e);
      std::sort(corners.begin(), corners.end());
      const auto found = sides.find(corners);
      if (found != sides.end() && found->second.element < 0) found->second = {e, side};
    }
  }
  return sides;
}

absl::Status GroupedMeshBuilder::ResolveFaceGroups(GroupedMesh& mesh) {
  MORTISE_ASSIGN_OR_RETURN(const SidesByCorners sides, FindSides(mesh));
  for (const auto& [owner, name, members, triangles] : face_groups_.groups) {
    FaceGroup group{name, {}};
    for (const Member& member : members) {
      const auto found = element_index_.find(member.number);
      if (found == element_index_.end()) {
        return places_.Fault(member.place, absl::StrCat("group '", name, "' names element ",
                                                        member.number, ", which does not exist"));
      }
      group.members.push_back({found->second, member.side});
    }
    for (const Triangle& triangle : triangles) {
      MORTISE_ASSIGN_OR_RETURN(const Corners corners, CornersOf(triangle));
      const ElementSide side = sides.at(corners);
      if (side.element < 0) {
        return places_.Fault(triangle.place, absl::StrCat("a triangle of group '", name,
                                                          "' is no face of a tetrahedron"));
      }
      group.members.push_back(side);
    }
    SortAndUnite(group.members);
    mesh.face_groups.push_back(std::move(group));
  }
  return NoteTrianglesApart(sides);
}

absl::Status GroupedMeshBuilder::NoteTrianglesApart(const SidesByCorners& sides) {
  std::size_t apart = 0;
  std::string first;
  for (const Triangle& triangle : loose_triangles_) {
    MORTISE_ASSIGN_OR_RETURN(const Corners corners, CornersOf(triangle));
    if (sides.at(corners).element < 0 && apart++ == 0) first = places_.Where(triangle.place);
  }
  if (apart > 0) {
    AddNote(absl::StrCat(first, ": ", apart,
                         apart == 1 ? " triangle is no face of a tetrahedron and was"
                                    : " triangles are no faces of tetrahedra and were",
                         " left out"));
  }
  return absl::OkStatus();
}

// `kept`: the new index of each node, -1 of those in no element.
absl::Status GroupedMeshBuilder::ResolveNodeGroups(const std::vector<int>& kept,
                                                   GroupedMesh& mesh) const {
  for (const auto& [owner, name, members, triangles] : node_groups_.groups) {
    NodeGroup group{name, {}};
    for (const Member& member : members) {
      const auto found = node_index_.find(member.number);
      if (found == node_index_.end()) {
        return places_.Fault(member.place, absl::StrCat("group '", name, "' names node ",
                                                        member.number, ", which does not exist"));
      }
      if (kept[found->second] >= 0) group.members.push_back(kept[found->second]);
    }
    SortAndUnite(group.members);
    mesh.node_groups.push_back(std::move(group));
  }
  return absl::OkStatus();
}

absl::StatusOr<GroupedMesh> GroupedMeshBuilder::Build() {
  if (element_numbers_.empty()) {
    return InvalidField("mesh_file", "has no tetrahedra");
  }
  NamePartGroups();
  GroupedMesh mesh;
  MORTISE_RETURN_IF_ERROR(ResolveElements(mesh));
  MORTISE_RETURN_IF_ERROR(MergeRepeats(mesh));
  MORTISE_RETURN_IF_ERROR(ResolveElementGroups(mesh));
  MORTISE_RETURN_IF_ERROR(ResolveFaceGroups(mesh));
  std::vector<int> kept(nodes_.size(), -1);
  for (Eigen::Index k = 0; k < mesh.tetrahedra.size(); ++k) kept[mesh.tetrahedra.data()[k]] = 0;
  int count = 0;
  for (int& index : kept) index = index == 0 ? count++ : -1;
  mesh.nodes.resize(3, count);
  mesh.node_numbers.resize(count);
  for (std::size_t v = 0; v < nodes_.size(); ++v) {
    if (kept[v] < 0) continue;
    mesh.nodes.col(kept[v]) = nodes_[v];
    mesh.node_numbers[kept[v]] = node_numbers_[v];
  }
  for (Eigen::Index k = 0; k < mesh.tetrahedra.size(); ++k) {
    int& node = mesh.tetrahedra.data()[k];
    node = kept[node];
  }
  MORTISE_RETURN_IF_ERROR(ResolveNodeGroups(kept, mesh));
  mesh.notes = std::move(notes_);
  if (const std::size_t unused = nodes_.size() - count; unused > 0) {
    mesh.notes.push_back(absl::StrCat(unused,
                                      unused == 1 ? " node belongs to no element and was"
                                                  : " nodes belong to no element and were",
                                      " left out"));
  }
  return mesh;
}

}  // namespace mortise::mesh
