#include "common/assembly/codec/assembly_codec.h"

#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/assembly/codec/assembly_drawing.h"
#include "common/assembly/codec/group_reader.h"
#include "common/assembly/codec/part_reader.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/design/field_checks.h"
#include "common/messages/message_digest.h"
#include "common/messages/vector_codec.h"

namespace mortise::parametric {
namespace {

using Findings = std::vector<FieldViolation>;

void ReadJoint(const v1::Joint& message, const std::string& field, const GroupReader& groups,
               AssemblyDrawing& drawing, Findings& findings) {
  CheckAssemblyName(field + ".name", message.name(), findings);
  Joint joint;
  joint.name = message.name();
  joint.group = groups.Find(message.group(), field + ".group");
  joint.center = VectorFromProto(message.center());
  joint.axis = VectorFromProto(message.axis());
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
      if (!joint.axis.allFinite()) findings.push_back({field + ".axis", "must be finite"});
      joint.axis = Eigen::Vector3d::UnitZ();
      break;
    default:
      findings.push_back({field + ".kind", "must be PRISMATIC, HINGE or BALL"});
  }
  std::set<std::string> names;
  for (int i = 0; i < message.rest_poses_size(); ++i) {
    const v1::RestPose& pose = message.rest_poses(i);
    const std::string place = absl::StrCat(field, ".rest_poses[", i, "].name");
    CheckAssemblyName(place, pose.name(), findings);
    if (!names.insert(pose.name()).second) {
      findings.push_back({place, absl::StrCat("'", pose.name(), "' occurs twice")});
    }
    const bool is_ball = joint.kind == JointKind::kBall;
    const std::string motion = absl::StrCat(field, ".rest_poses[", i, "]");
    if (is_ball && pose.amount() != 0) {
      findings.push_back({motion + ".amount", "is not of ball joints: give their `rotation`"});
    } else if (!is_ball && !VectorFromProto(pose.rotation()).isZero(0)) {
      findings.push_back({motion + ".rotation", "is of ball joints only: give the `amount`"});
    }
    joint.rest_poses.push_back({pose.name(), is_ball
                                                 ? VectorFromProto(pose.rotation())
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
FieldViolation AtMessage(const FieldViolation& finding, const v1::Assembly& message,
                         const AssemblyDrawing& drawing) {
  const std::string rest =
      finding.field.substr(std::min(finding.field.find(']') + 1, finding.field.size()));
  if (const int part = IndexIn(finding.field, "parts"); part >= 0) {
    const auto index = static_cast<std::size_t>(part);
    const std::string& place = drawing.part_fields[index];
    const v1::AssemblyPart& drawn = message.parts(IndexIn(place, "parts"));
    // Boxes and limits are made of the message's positions and sizes.
    const bool is_nowhere =
        VectorFromProto(drawn.size()).allFinite() && !VectorFromProto(drawn.position()).allFinite();
    const std::string field = absl::StrReplaceAll(
        rest, {{".limits", ".size"}, {".box", is_nowhere ? ".position" : ".size"}});
    return {place + field,
            absl::StrCat("'", drawing.assembly.parts[index].name, "': ", finding.message)};
  }
  if (const int group = IndexIn(finding.field, "groups"); group > 0) {
    const int index = drawing.group_messages[static_cast<std::size_t>(group) - 1];
    return {absl::StrCat("groups[", index, "]", rest), finding.message};
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
bool MissesParts(const std::string& group, const v1::Assembly& message,
                 const AssemblyDrawing& drawing) {
  if (drawing.assembly.parts.size() == kMaxAssemblyParts) return true;
  const std::set<std::string> read(drawing.part_fields.begin(), drawing.part_fields.end());
  for (int i = 0; i < message.parts_size(); ++i) {
    if (read.contains(absl::StrCat("parts[", i, "]"))) continue;
    if (IsWithin(message, message.parts(i).group(), group)) return true;
  }
  return false;
}

// Whether a finding only says what was left out because of findings before.
bool IsConsequence(const FieldViolation& finding, const v1::Assembly& message,
                   const AssemblyDrawing& drawing) {
  if (finding.field == "parts") return message.parts_size() > 0;
  if (finding.field == "groups[0].name") return true;  // the root is called as the assembly
  const int joint = IndexIn(finding.field, "joints");
  if (joint < 0) return false;
  if (finding.field.find("].rest_poses[") != std::string::npos) {
    // Motions are made of amounts and axes.
    return !drawing.assembly.joints[static_cast<std::size_t>(joint)].axis.allFinite();
  }
  if (!finding.field.ends_with("].group")) return false;
  return drawing.assembly.joints[static_cast<std::size_t>(joint)].group < 0 ||
         MissesParts(message.joints(joint).group(), message, drawing);
}

}  // namespace

absl::StatusOr<Assembly> FromProto(const v1::Assembly& message, const std::vector<Item>& items,
                                   const ShapesByName& shapes) {
  Findings findings;
  AssemblyDrawing drawing;
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
  for (const FieldViolation& finding : ValidateAssembly(drawing.assembly)) {
    if (IsConsequence(finding, message, drawing)) continue;
    findings.push_back(AtMessage(finding, message, drawing));
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
  assembly.clear_external_ids();
  assembly.clear_labels();
  assembly.clear_creator();
  ClearRevisions(*content.mutable_items(), *content.mutable_materials());
  return MessageDigest(content);
}

}  // namespace mortise::parametric
