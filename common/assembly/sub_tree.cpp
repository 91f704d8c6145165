#include "common/assembly/sub_tree.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/trial/drawn_contacts.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"

namespace mortise::parametric {
namespace {

constexpr int kNone = -1;
constexpr double kReached = 1e-4;  // m

// A node of the assembly's tree, and which parts are drawn below it.
struct Node {
  int group = kNone;         // of the assembly; none where the node is a part or row
  std::vector<bool> inside;  // of each part
};

int FindGroup(const Assembly& assembly, const std::string& name) {
  for (std::size_t i = 1; i < assembly.groups.size(); ++i) {
    if (assembly.groups[i].name == name) return static_cast<int>(i);
  }
  return kNone;
}

bool IsNumber(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char letter) {
    return std::isdigit(static_cast<unsigned char>(letter)) != 0;
  });
}

// Tells whether a part of this name is one of the row or grid: "shelf 3" of "shelf", "screw 1.2" of
// "screw".
bool IsOfRow(std::string_view part, std::string_view row) {
  if (!part.starts_with(row) || part.substr(row.size(), 1) != " ") return false;
  const std::string_view place = part.substr(row.size() + 1);
  const std::size_t dot = place.find('.');
  if (dot == std::string_view::npos) return IsNumber(place);
  return IsNumber(place.substr(0, dot)) && IsNumber(place.substr(dot + 1));
}

template <typename Predicate>
std::vector<bool> PartsThat(const Assembly& assembly, const Predicate& is_wanted) {
  std::vector<bool> wanted;
  for (const AssemblyPart& part : assembly.parts) wanted.push_back(is_wanted(part));
  return wanted;
}

bool HasAny(const std::vector<bool>& parts) {
  return std::find(parts.begin(), parts.end(), true) != parts.end();
}

// What a node may be called by.
std::vector<std::string> NamesIn(const Assembly& assembly) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i < assembly.groups.size(); ++i) {
    names.push_back(assembly.groups[i].name);
  }
  for (const AssemblyPart& part : assembly.parts) names.push_back(part.name);
  return names;
}

absl::StatusOr<Node> FindNode(const Assembly& assembly, const std::string& name) {
  Node node;
  node.group = FindGroup(assembly, name);
  if (node.group != kNone) {
    node.inside = PartsThat(assembly, [&](const AssemblyPart& part) {
      return IsWithin(assembly, part.group, node.group);
    });
    return node;
  }
  node.inside = PartsThat(assembly, [&](const AssemblyPart& part) { return part.name == name; });
  if (HasAny(node.inside)) return node;
  node.inside =
      PartsThat(assembly, [&](const AssemblyPart& part) { return IsOfRow(part.name, name); });
  if (HasAny(node.inside)) return node;
  return InvalidField("group", absl::StrCat("there is no group or part '", name, "' in ",
                                            assembly.name, NamesOffered(name, NamesIn(assembly))));
}

// Of each part whether it, or what it belongs together with, touches principal parts inside and
// outside of the sub-tree.
struct Reach {
  std::vector<bool> in, out;
};

Reach ReachOf(const Assembly& assembly, const TouchingParts& touching,
              const std::vector<bool>& inside) {
  const std::vector<int> together = ConnectingTogether(assembly, touching);
  Reach of_whole{std::vector<bool>(inside.size(), false), std::vector<bool>(inside.size(), false)};
  const auto note = [&](int connecting, int principal) {
    const auto of = static_cast<std::size_t>(together[static_cast<std::size_t>(connecting)]);
    (inside[static_cast<std::size_t>(principal)] ? of_whole.in : of_whole.out)[of] = true;
  };
  for (const auto& [a, b] : touching) {
    const bool a_connects = assembly.parts[static_cast<std::size_t>(a)].connecting;
    const bool b_connects = assembly.parts[static_cast<std::size_t>(b)].connecting;
    if (a_connects && !b_connects) note(a, b);
    if (b_connects && !a_connects) note(b, a);
  }
  Reach reach;
  for (const int of : together) {
    reach.in.push_back(of_whole.in[static_cast<std::size_t>(of)]);
    reach.out.push_back(of_whole.out[static_cast<std::size_t>(of)]);
  }
  return reach;
}

// Which parts the sub-tree has.
std::vector<bool> PartsThatStay(const Assembly& assembly, const TouchingParts& touching,
                                const std::vector<bool>& inside) {
  const Reach reach = ReachOf(assembly, touching, inside);
  std::vector<bool> stays = inside;
  for (std::size_t i = 0; i < stays.size(); ++i) {
    if (assembly.parts[i].connecting) stays[i] = !reach.out[i] && (reach.in[i] || inside[i]);
  }
  return stays;
}

// Whether two boxes have more in common than faces that lie against each other.
bool ReachIntoEachOther(const BoundingBox& a, const BoundingBox& b) {
  return (a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum)).minCoeff() > kReached;
}

// Of each connecting part whether it, or what it belongs together with, holds parts outside of the
// sub-tree together by itself: it reaches into several of them, and into none inside, as a screw
// does whose tip only just comes to the face of a board.
std::vector<bool> HoldByThemselves(const Assembly& assembly, const TouchingParts& touching,
                                   const std::vector<bool>& inside) {
  const std::vector<int> together = ConnectingTogether(assembly, touching);
  std::vector<std::set<int>> reached(inside.size());
  for (const auto& [a, b] : touching) {
    const AssemblyPart& first = assembly.parts[static_cast<std::size_t>(a)];
    const AssemblyPart& second = assembly.parts[static_cast<std::size_t>(b)];
    if (first.connecting == second.connecting) continue;
    if (!ReachIntoEachOther(first.box, second.box)) continue;
    const int connecting = first.connecting ? a : b;
    const auto of = static_cast<std::size_t>(together[static_cast<std::size_t>(connecting)]);
    reached[of].insert(first.connecting ? b : a);
  }
  std::vector<bool> hold;
  for (const int of : together) {
    const std::set<int>& principals = reached[static_cast<std::size_t>(of)];
    hold.push_back(principals.size() > 1 &&
                   std::none_of(principals.begin(), principals.end(), [&](int principal) {
                     return inside[static_cast<std::size_t>(principal)];
                   }));
  }
  return hold;
}

// Which parts are left without the sub-tree.
std::vector<bool> PartsLeft(const Assembly& assembly, const TouchingParts& touching,
                            const std::vector<bool>& inside) {
  const Reach reach = ReachOf(assembly, touching, inside);
  const std::vector<bool> hold = HoldByThemselves(assembly, touching, inside);
  std::vector<bool> left;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    const bool stays = (hold[i] || !reach.in[i]) && (reach.out[i] || !inside[i]);
    left.push_back(assembly.parts[i].connecting ? stays : !inside[i]);
  }
  return left;
}

// The groups that parts are left in, and those above them. Gives of each group of the assembly its
// index then; 0 for those that are gone.
std::vector<int> KeepGroups(const Assembly& assembly, const std::vector<bool>& left,
                            Assembly& made) {
  std::vector<bool> holds(assembly.groups.size(), false);
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (!left[i]) continue;
    for (int group = assembly.parts[i].group; group > 0;
         group = assembly.groups[static_cast<std::size_t>(group)].parent) {
      holds[static_cast<std::size_t>(group)] = true;
    }
  }
  std::vector<int> index_of(assembly.groups.size(), 0);
  made.groups = {assembly.groups.front()};
  for (std::size_t group = 1; group < holds.size(); ++group) {
    if (!holds[group]) continue;
    index_of[group] = static_cast<int>(made.groups.size());
    made.groups.push_back(assembly.groups[group]);
  }
  for (std::size_t i = 1; i < made.groups.size(); ++i) {
    int& parent = made.groups[i].parent;
    parent = index_of[static_cast<std::size_t>(parent)];
  }
  return index_of;
}

// Puts the parts that stay into their groups. Whether a principal part is among them.
bool AddParts(const Assembly& assembly, const std::vector<bool>& stays,
              const std::vector<int>& index_of, Assembly& made) {
  bool has_principal = false;
  for (std::size_t i = 0; i < stays.size(); ++i) {
    if (!stays[i]) continue;
    AssemblyPart& part = made.parts.emplace_back(assembly.parts[i]);
    part.group = index_of[static_cast<std::size_t>(part.group)];
    has_principal |= !part.connecting;
  }
  return has_principal;
}

// The groups of the sub-tree, the node first. Gives of each group of the assembly the index of
// where its parts are then: those of groups that are not in the sub-tree are in its root.
std::vector<int> AddGroups(const Assembly& assembly, int node, Assembly& made) {
  std::vector<int> index_of(assembly.groups.size(), 0);
  made.groups = {{assembly.name, -1}};
  if (node == kNone) return index_of;
  for (int group = 0; group < static_cast<int>(assembly.groups.size()); ++group) {
    if (group == node || !IsWithin(assembly, group, node)) continue;
    index_of[static_cast<std::size_t>(group)] = static_cast<int>(made.groups.size());
    made.groups.push_back(assembly.groups[static_cast<std::size_t>(group)]);
  }
  for (std::size_t i = 1; i < made.groups.size(); ++i) {
    int& parent = made.groups[i].parent;
    parent = index_of[static_cast<std::size_t>(parent)];
  }
  return index_of;
}

// Joints of groups below the node, as far as there is something left to move.
void AddJoints(const Assembly& assembly, const std::vector<int>& index_of, Assembly& made) {
  for (Joint joint : assembly.joints) {
    joint.group = index_of[static_cast<std::size_t>(joint.group)];
    if (joint.group == 0) continue;
    const bool moves = std::any_of(
        made.parts.begin(), made.parts.end(),
        [&](const AssemblyPart& part) { return IsWithin(made, part.group, joint.group); });
    if (moves) made.joints.push_back(std::move(joint));
  }
}

absl::Status NoPrincipalParts(const std::string& node) {
  return InvalidField("group", absl::StrCat("'", node, "' has no principal parts"));
}

// What a part looks like, and where it lies from `corner` in multiples of `tolerance`.
using Appearance = std::tuple<const mesh::DrawnShape*, std::string, bool, std::vector<long>>;

Appearance AppearanceOf(const AssemblyPart& part, const Eigen::Vector3d& corner, double tolerance) {
  std::vector<long> numbers;
  for (int axis = 0; axis < 3; ++axis) {
    numbers.push_back(std::lround((part.box.minimum[axis] - corner[axis]) / tolerance));
    numbers.push_back(std::lround(part.box.size()[axis] / tolerance));
    numbers.push_back(static_cast<long>(part.item_axes[static_cast<std::size_t>(axis)]));
  }
  return {part.shape.get(), part.item, part.connecting, std::move(numbers)};
}

std::vector<Appearance> AppearanceOf(const Assembly& assembly, double tolerance) {
  Eigen::Vector3d corner = assembly.parts.front().box.minimum;
  for (const AssemblyPart& part : assembly.parts) corner = corner.cwiseMin(part.box.minimum);
  std::vector<Appearance> parts;
  for (const AssemblyPart& part : assembly.parts) {
    parts.push_back(AppearanceOf(part, corner, tolerance));
  }
  std::sort(parts.begin(), parts.end());
  return parts;
}

}  // namespace

std::vector<std::string> DistinctSubTrees(const Assembly& assembly) {
  // Coarser than what drawings are exact to, so that rounding seldom tells like from like.
  const double tolerance = 1000 * ToleranceOf(assembly);
  std::vector<std::string> names;
  std::set<std::vector<Appearance>> known;
  for (std::size_t group = 1; group < assembly.groups.size(); ++group) {
    const std::string& name = assembly.groups[group].name;
    const absl::StatusOr<Assembly> made = SubTreeOf(assembly, name);
    if (!made.ok() || made->parts.size() < 2 || made->parts.size() == assembly.parts.size()) {
      continue;
    }
    if (known.insert(AppearanceOf(*made, tolerance)).second) names.push_back(name);
  }
  return names;
}

absl::StatusOr<Assembly> SubTreeOf(const Assembly& assembly, const std::string& node) {
  if (node.empty()) return assembly;
  MORTISE_ASSIGN_OR_RETURN(const Node found, FindNode(assembly, node));
  MORTISE_ASSIGN_OR_RETURN(const TouchingParts touching,
                           FindTouchingParts(assembly, ToleranceOf(assembly)));
  const std::vector<bool> stays = PartsThatStay(assembly, touching, found.inside);
  Assembly made;
  made.name = assembly.name;
  const std::vector<int> index_of = AddGroups(assembly, found.group, made);
  if (!AddParts(assembly, stays, index_of, made)) return NoPrincipalParts(node);
  AddJoints(assembly, index_of, made);
  return made;
}

absl::StatusOr<std::vector<std::string>> PartsOfNode(const Assembly& assembly,
                                                     const std::string& node) {
  Node found;
  found.inside.assign(assembly.parts.size(), true);
  if (!node.empty()) {
    MORTISE_ASSIGN_OR_RETURN(found, FindNode(assembly, node));
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    if (found.inside[i]) names.push_back(assembly.parts[i].name);
  }
  return names;
}

absl::StatusOr<Assembly> WithoutSubTree(const Assembly& assembly, const std::string& node) {
  Node found;
  found.inside.assign(assembly.parts.size(), true);
  if (!node.empty()) {
    MORTISE_ASSIGN_OR_RETURN(found, FindNode(assembly, node));
  }
  bool has_principal = false;
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    has_principal |= found.inside[i] && !assembly.parts[i].connecting;
  }
  if (!has_principal) return NoPrincipalParts(node);
  MORTISE_ASSIGN_OR_RETURN(const TouchingParts touching,
                           FindTouchingParts(assembly, ToleranceOf(assembly)));
  const std::vector<bool> left = PartsLeft(assembly, touching, found.inside);
  Assembly made;
  made.name = assembly.name;
  const std::vector<int> index_of = KeepGroups(assembly, left, made);
  if (!AddParts(assembly, left, index_of, made)) {
    return PreconditionFailed("NOTHING_LEFT",
                              absl::StrCat("without '", node, "' no principal part is left"));
  }
  AddJoints(assembly, index_of, made);
  return made;
}

}  // namespace mortise::parametric
