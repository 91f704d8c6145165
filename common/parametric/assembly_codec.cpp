#include "common/parametric/assembly_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/parametric/axis_codec.h"
#include "common/parametric/field_checks.h"
#include "common/parametric/message_digest.h"
#include "common/parametric/shape_reader.h"

namespace mortise::parametric {
namespace {

using google::protobuf::RepeatedPtrField;
using Findings = std::vector<Finding>;

constexpr std::size_t kMaxName = 63;  // bytes
constexpr std::size_t kMaxParts = 2000;
constexpr int kMaxRepeat = 1000;
constexpr int kMaxGroups = 1000;
// Of the drawn size, what a part without an item may measure.
constexpr double kLeastGrowth = 0.5;
constexpr double kMostGrowth = 2;

Eigen::Vector3d ToEigen(const v1::Vector3& vector) { return {vector.x(), vector.y(), vector.z()}; }

void CheckName(const std::string& field, const std::string& name, Findings& findings) {
  const bool printable = std::all_of(name.begin(), name.end(), [](char c) {
    return static_cast<unsigned char>(c) >= ' ' && c != 127;
  });
  if (name.empty() || name.size() > kMaxName || !printable) {
    findings.push_back(
        {field, absl::StrCat("must be 1 to ", kMaxName, " bytes of text in one line")});
  }
}

// Where parts of the struct come from in the message, for the places of findings.
struct Drawing {
  Assembly assembly;
  std::vector<std::string> part_fields;  // of each part: "parts[3]"
  std::vector<int> group_messages;       // of each group but the root, index into the message
};

// --- Groups.

class GroupReader {
 public:
  GroupReader(const v1::Assembly& message, Findings& findings)
      : message_(message), findings_(findings) {}

  // The root first, then parents before children.
  void Read(Drawing& drawing) {
    if (message_.groups_size() > kMaxGroups) {
      findings_.push_back({"groups", absl::StrCat("are more than ", kMaxGroups)});
    }
    drawing.assembly.groups = {{message_.name(), -1}};
    const int count = std::min(message_.groups_size(), kMaxGroups);
    for (int i = 0; i < count; ++i) {
      const v1::AssemblyGroup& group = message_.groups(i);
      const std::string field = absl::StrCat("groups[", i, "]");
      CheckName(field + ".name", group.name(), findings_);
      if (!names_.insert(group.name()).second) {
        findings_.push_back({field + ".name", absl::StrCat("'", group.name(), "' occurs twice")});
      }
      children_[group.parent()].push_back(i);
    }
    AddChildren("", 0, drawing);
    for (int i = 0; i < count; ++i) CheckReached(i);
    index_[""] = 0;
  }

  // Index of a group of the struct; -1 if there is none of this name, and a finding if the message
  // has none either.
  int Find(const std::string& name, const std::string& field) const {
    const auto found = index_.find(name);
    if (found != index_.end()) return found->second;
    if (!names_.contains(name))
      findings_.push_back({field, absl::StrCat("there is no group '", name, "'")});
    return -1;
  }

 private:
  void AddChildren(const std::string& parent, int parent_index, Drawing& drawing) {
    const auto children = children_.find(parent);
    if (children == children_.end()) return;
    for (const int i : children->second) {
      const std::string& name = message_.groups(i).name();
      // A name given twice is a finding already; an empty one would be the root.
      if (name.empty() || index_.contains(name)) continue;
      const int index = static_cast<int>(drawing.assembly.groups.size());
      index_[name] = index;
      drawing.assembly.groups.push_back({name, parent_index});
      drawing.group_messages.push_back(i);
      AddChildren(name, index, drawing);
    }
  }

  void CheckReached(int i) {
    const v1::AssemblyGroup& group = message_.groups(i);
    if (group.name().empty() || index_.contains(group.name())) return;
    findings_.push_back({absl::StrCat("groups[", i, "].parent"),
                         names_.contains(group.parent())
                             ? "the hierarchy goes in a circle, or hangs on one that does"
                             : absl::StrCat("there is no group '", group.parent(), "'")});
  }

  const v1::Assembly& message_;
  Findings& findings_;
  std::map<std::string, std::vector<int>> children_;  // of the message, by parent's name
  std::map<std::string, int> index_;                  // into the struct, by name
  std::set<std::string> names_;                       // of the message
};

// --- Parts.

// Which axis of the design each of the item's three lies along; nothing, and a finding, if two
// would lie along one.
std::optional<std::array<Axis, 3>> ItemAxes(const v1::AssemblyPart& part, const std::string& field,
                                            Findings& findings) {
  const auto axis_of = [&](v1::Axis axis, Axis usual, const char* name) -> std::optional<Axis> {
    if (axis == v1::AXIS_UNSPECIFIED) return usual;
    const auto known = AxisFromProto(axis, absl::StrCat(field, name));
    if (known.ok()) return *known;
    findings.push_back({absl::StrCat(field, name), "must be X, Y or Z"});
    return std::nullopt;
  };
  const auto length = axis_of(part.length_axis(), Axis::kX, ".length_axis");
  const auto thickness = axis_of(part.thickness_axis(), Axis::kZ, ".thickness_axis");
  if (!length || !thickness) return std::nullopt;
  if (*length == *thickness) {
    findings.push_back(
        {field + ".thickness_axis", "is the length_axis too; unspecified, they are Z and X"});
    return std::nullopt;
  }
  const int width = 3 - static_cast<int>(*length) - static_cast<int>(*thickness);
  return std::array<Axis, 3>{*length, static_cast<Axis>(width), *thickness};
}

// Limits along the design's axes, and the size where it is left to the item.
void ApplyItem(const Item& item, const std::array<Axis, 3>& axes, AssemblyPart& part,
               Eigen::Vector3d& size) {
  part.item_axes = axes;
  for (std::size_t i = 0; i < 3; ++i) {
    const ItemDimension& dimension = item.dimensions[i];
    const auto axis = static_cast<std::size_t>(axes[i]);
    const bool is_fixed = dimension.process == Process::kNone;
    part.limits[axis] = is_fixed ? SizeLimits{dimension.size, dimension.size}
                                 : SizeLimits{dimension.minimum, dimension.maximum};
    auto& along = size[static_cast<Eigen::Index>(axis)];
    if (is_fixed && along == 0) along = dimension.size;
  }
}

// What a part may measure of which nobody says what it is made of.
void ApplyDrawnSize(const Eigen::Vector3d& size, AssemblyPart& part) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double drawn = size[static_cast<Eigen::Index>(axis)];
    part.limits[axis] = part.connecting ? SizeLimits{drawn, drawn}
                                        : SizeLimits{kLeastGrowth * drawn, kMostGrowth * drawn};
  }
}

// Whether steps along one direction of a grid lead to where steps along the other do.
bool Coincide(const v1::Repeat& first, const v1::Repeat& second) {
  constexpr double kSameStep = 1e-9;
  const Eigen::Vector3d one = ToEigen(first.offset()), other = ToEigen(second.offset());
  const double share = one.dot(other) / other.squaredNorm();  // of `other` that `one` is
  if ((one - share * other).norm() > kSameStep * one.norm()) return false;
  for (int steps = 1; steps < first.count(); ++steps) {
    const double there = std::abs(steps * share);
    if (std::round(there) >= second.count()) return false;
    if (std::abs(there - std::round(there)) <= kSameStep * there) return true;
  }
  return false;
}

// What the name of each of a row's parts ends with, and where it stands against the first.
using Places = std::vector<std::pair<std::string, Eigen::Vector3d>>;

// What can be read of them, and findings about the rest.
Places Repetitions(const v1::AssemblyPart& part, const std::string& field, Findings& findings) {
  Places places = {{"", Eigen::Vector3d::Zero()}};
  if (part.repeat_size() > 2) {
    findings.push_back({field + ".repeat", "has at most two directions"});
    return places;
  }
  for (int r = 0; r < part.repeat_size(); ++r) {
    const v1::Repeat& repeat = part.repeat(r);
    const std::string place = absl::StrCat(field, ".repeat[", r, "]");
    const Eigen::Vector3d offset = ToEigen(repeat.offset());
    if (repeat.count() < 2 || repeat.count() > kMaxRepeat) {
      findings.push_back({place + ".count", absl::StrCat("must be 2 to ", kMaxRepeat)});
      return places;
    }
    if (!offset.allFinite() || offset.isZero()) {
      findings.push_back({place + ".offset", "must be finite and not 0"});
      return places;
    }
    if (r == 1 && Coincide(part.repeat(0), repeat)) {
      findings.push_back({place + ".offset", "puts parts where repeat[0] has put some"});
      return places;
    }
    Places more;
    for (const auto& [name, from] : places) {
      for (int i = 0; i < repeat.count(); ++i) {
        more.emplace_back(absl::StrCat(name, r == 0 ? " " : ".", i + 1), from + i * offset);
      }
    }
    places = std::move(more);
    if (places.size() > kMaxParts) break;
  }
  return places;
}

class PartReader {
 public:
  PartReader(const std::vector<Item>& items, const ShapesByName& shapes, const GroupReader& groups,
             Findings& findings)
      : items_(items), shapes_(shapes, findings), groups_(groups), findings_(findings) {}

  void Read(const v1::AssemblyPart& message, const std::string& field, Drawing& drawing) {
    CheckName(field + ".name", message.name(), findings_);
    CheckTitle(field + ".title", message.title(), findings_);
    AssemblyPart part;
    part.item = message.item();
    part.group = groups_.Find(message.group(), field + ".group");
    part.connecting = message.role() == v1::AssemblyPart::CONNECTING;
    if (!v1::AssemblyPart::Role_IsValid(message.role())) {
      findings_.push_back({field + ".role", "must be PRINCIPAL or CONNECTING"});
    }
    ReadPlanes(message, field, part);
    Eigen::Vector3d size = ToEigen(message.size());
    const Item* const item = FindItem(items_, message.item());
    const bool has_item = !message.item().empty();
    if (has_item && item == nullptr) {
      findings_.push_back(
          {field + ".item", absl::StrCat("there is no item '", message.item(), "'")});
    }
    const auto axes = ItemAxes(message, field, findings_);
    if (item != nullptr && axes) ApplyItem(*item, *axes, part, size);
    if (!has_item) ApplyDrawnSize(size, part);
    if (!has_item && axes) part.item_axes = *axes;
    if (message.has_color()) ReadColor(message.color(), field + ".color", part);
    if (axes) shapes_.Read(message, field, item, size, part);
    // Without its item, size and limits of a part would be found wrong again and again.
    const bool complete = (item != nullptr || !has_item) && axes && part.group >= 0;
    const Places places = Repetitions(message, field, findings_);
    CheckIncomplete(message.name(), field, complete);
    if (complete) AddAll(message, field, part, size, places, drawing);
  }

 private:
  void ReadPlanes(const v1::AssemblyPart& message, const std::string& field, AssemblyPart& part) {
    std::set<std::string> names;
    for (int i = 0; i < message.prominent_planes_size(); ++i) {
      const v1::ProminentPlane& plane = message.prominent_planes(i);
      const std::string place = absl::StrCat(field, ".prominent_planes[", i, "]");
      CheckName(place + ".name", plane.name(), findings_);
      if (!names.insert(plane.name()).second) {
        findings_.push_back({place + ".name", absl::StrCat("'", plane.name(), "' occurs twice")});
      }
      const auto axis = AxisFromProto(plane.axis(), place + ".axis");
      if (!axis.ok()) {
        findings_.push_back({place + ".axis", "must be X, Y or Z"});
        continue;
      }
      part.prominent_planes.push_back({plane.name(), *axis, plane.position()});
    }
  }

  void ReadColor(const v1::Vector3& color, const std::string& field, AssemblyPart& part) {
    part.color = ToEigen(color);
    if (!(part.color->minCoeff() >= 0 && part.color->maxCoeff() <= 1)) {
      findings_.push_back({field, "must be three numbers between 0 and 1"});
    }
  }

  // Of two parts of one name that both are complete, ValidateAssembly tells.
  void CheckIncomplete(const std::string& name, const std::string& field, bool complete) {
    const auto [known, is_new] = complete_.emplace(name, complete);
    if (is_new || name.empty()) return;
    if (!complete || !known->second) {
      findings_.push_back({field + ".name", absl::StrCat("'", name, "' occurs twice")});
    }
    known->second = known->second && complete;
  }

  void AddAll(const v1::AssemblyPart& message, const std::string& field, const AssemblyPart& first,
              const Eigen::Vector3d& size, const Places& places, Drawing& drawing) {
    const Eigen::Vector3d position = ToEigen(message.position());
    for (const auto& [suffix, offset] : places) {
      if (drawing.assembly.parts.size() == kMaxParts) {
        if (!full_) findings_.push_back({"parts", absl::StrCat("are more than ", kMaxParts)});
        full_ = true;
        return;
      }
      AssemblyPart part = first;
      part.name = message.name() + suffix;
      part.box.minimum = position + offset;
      part.box.maximum = part.box.minimum + size;
      for (ProminentPlane& plane : part.prominent_planes) {
        plane.position += offset[static_cast<Eigen::Index>(plane.axis)];
      }
      AddPlanesOfShape(part);
      drawing.assembly.parts.push_back(std::move(part));
      drawing.part_fields.push_back(field);
    }
  }

  const std::vector<Item>& items_;
  ShapeReader shapes_;
  const GroupReader& groups_;
  Findings& findings_;
  bool full_ = false;                     // and that has been said
  std::map<std::string, bool> complete_;  // of each part's name, whether all parts so called are
};

// --- Joints.

void ReadJoint(const v1::Joint& message, const std::string& field, const GroupReader& groups,
               Drawing& drawing, Findings& findings) {
  CheckName(field + ".name", message.name(), findings);
  Joint joint;
  joint.name = message.name();
  joint.group = groups.Find(message.group(), field + ".group");
  joint.center = ToEigen(message.center());
  joint.axis = ToEigen(message.axis());
  joint.lower = message.lower();
  joint.upper = message.upper();
  switch (message.kind()) {
    case v1::Joint::PRISMATIC:
      joint.kind = JointKind::kPrismatic;
      break;
    case v1::Joint::HINGE:
      joint.kind = JointKind::kHinge;
      break;
    case v1::Joint::BALL:
      joint.kind = JointKind::kBall;
      joint.axis = Eigen::Vector3d::UnitZ();
      break;
    default:
      findings.push_back({field + ".kind", "must be PRISMATIC, HINGE or BALL"});
  }
  std::set<std::string> names;
  for (int i = 0; i < message.rest_poses_size(); ++i) {
    const v1::RestPose& pose = message.rest_poses(i);
    const std::string place = absl::StrCat(field, ".rest_poses[", i, "].name");
    CheckName(place, pose.name(), findings);
    if (!names.insert(pose.name()).second) {
      findings.push_back({place, absl::StrCat("'", pose.name(), "' occurs twice")});
    }
    const bool is_ball = joint.kind == JointKind::kBall;
    const std::string motion = absl::StrCat(field, ".rest_poses[", i, "]");
    if (is_ball && pose.amount() != 0) {
      findings.push_back({motion + ".amount", "is not of ball joints: give their `rotation`"});
    } else if (!is_ball && !ToEigen(pose.rotation()).isZero(0)) {
      findings.push_back({motion + ".rotation", "is of ball joints only: give the `amount`"});
    }
    joint.rest_poses.push_back({pose.name(), is_ball
                                                 ? ToEigen(pose.rotation())
                                                 : Eigen::Vector3d(pose.amount() * joint.axis)});
  }
  drawing.assembly.joints.push_back(std::move(joint));
}

// The index in a field path such as "parts[3].box"; -1 if it is not of `list`.
int IndexIn(const std::string& field, const std::string& list) {
  if (!field.starts_with(list + "[")) return -1;
  return std::stoi(field.substr(list.size() + 1));
}

// A finding about the struct, at its place in the message.
Finding AtMessage(const Finding& finding, const Drawing& drawing) {
  const std::string rest =
      finding.field.substr(std::min(finding.field.find(']') + 1, finding.field.size()));
  if (const int part = IndexIn(finding.field, "parts"); part >= 0) {
    const auto index = static_cast<std::size_t>(part);
    // Boxes and limits are made of the message's positions and sizes.
    const std::string field = absl::StrReplaceAll(rest, {{".limits", ".size"}, {".box", ".size"}});
    return {drawing.part_fields[index] + field,
            absl::StrCat("'", drawing.assembly.parts[index].name, "': ", finding.message)};
  }
  if (const int group = IndexIn(finding.field, "groups"); group > 0) {
    const int message = drawing.group_messages[static_cast<std::size_t>(group) - 1];
    return {absl::StrCat("groups[", message, "]", rest), finding.message};
  }
  return finding;
}

// Whether one group of the message is another or below it; of hierarchies with faults as well.
bool IsWithin(const v1::Assembly& message, std::string group, const std::string& ancestor) {
  for (int depth = 0; depth <= message.groups_size() && group != ancestor; ++depth) {
    const auto found =
        std::find_if(message.groups().begin(), message.groups().end(),
                     [&](const v1::AssemblyGroup& other) { return other.name() == group; });
    if (found == message.groups().end()) return false;
    group = found->parent();
  }
  return group == ancestor;
}

// Whether parts of a group, or below it, could not be read.
bool MissesParts(const std::string& group, const v1::Assembly& message, const Drawing& drawing) {
  if (drawing.assembly.parts.size() == kMaxParts) return true;
  const std::set<std::string> read(drawing.part_fields.begin(), drawing.part_fields.end());
  for (int i = 0; i < message.parts_size(); ++i) {
    if (read.contains(absl::StrCat("parts[", i, "]"))) continue;
    if (IsWithin(message, message.parts(i).group(), group)) return true;
  }
  return false;
}

// Whether a finding only says what was left out because of findings before.
bool IsConsequence(const Finding& finding, const v1::Assembly& message, const Drawing& drawing) {
  if (finding.field == "parts") return message.parts_size() > 0;
  if (finding.field == "groups[0].name") return true;  // the root is called as the assembly
  const int joint = IndexIn(finding.field, "joints");
  if (joint < 0 || !finding.field.ends_with("].group")) return false;
  return drawing.assembly.joints[static_cast<std::size_t>(joint)].group < 0 ||
         MissesParts(message.joints(joint).group(), message, drawing);
}

}  // namespace

absl::StatusOr<Assembly> FromProto(const v1::Assembly& message, const std::vector<Item>& items,
                                   const ShapesByName& shapes) {
  Findings findings;
  Drawing drawing;
  if (const absl::Status name = ParseResourceName(message.name(), "assemblies", "name").status();
      !name.ok()) {
    findings.push_back({"name",
                        "must be 'assemblies/' and 1 to 63 lower-case letters, digits and "
                        "hyphens"});
  }
  CheckTitle("title", message.title(), findings);
  CheckDescription("description", message.description(), findings);
  drawing.assembly.name = message.name();
  GroupReader groups(message, findings);
  groups.Read(drawing);
  PartReader parts(items, shapes, groups, findings);
  for (int i = 0; i < message.parts_size(); ++i) {
    parts.Read(message.parts(i), absl::StrCat("parts[", i, "]"), drawing);
  }
  std::set<std::string> joints;
  for (int i = 0; i < message.joints_size(); ++i) {
    const std::string field = absl::StrCat("joints[", i, "]");
    ReadJoint(message.joints(i), field, groups, drawing, findings);
    if (!joints.insert(message.joints(i).name()).second) {
      findings.push_back(
          {field + ".name", absl::StrCat("'", message.joints(i).name(), "' occurs twice")});
    }
  }
  for (const Finding& finding : ValidateAssembly(drawing.assembly)) {
    if (IsConsequence(finding, message, drawing)) continue;
    findings.push_back(AtMessage(finding, drawing));
  }
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  return std::move(drawing.assembly);
}

std::string BundleDigest(const v1::AssemblyBundle& message) {
  v1::AssemblyBundle content = message;
  content.clear_shapes();  // their names say what they are
  v1::Assembly& assembly = *content.mutable_assembly();
  assembly.clear_name();
  assembly.clear_revision();
  assembly.clear_digest();
  assembly.clear_create_time();
  ClearRevisions(*content.mutable_items(), *content.mutable_materials());
  return MessageDigest(content);
}

}  // namespace mortise::parametric
