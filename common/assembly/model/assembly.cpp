// The hierarchy of an assembly, and its checks.
#include "common/assembly/model/assembly.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::parametric {
namespace {

constexpr double kUnitTolerance = 1e-9;
constexpr double kLimitTolerance = 1e-9;  // m or rad; what rounding in a file may cost
constexpr double kSamePlace = 1e-7;       // m

using Findings = std::vector<FieldViolation>;

bool IsGroup(const Assembly& assembly, int group) {
  return group >= 0 && group < static_cast<int>(assembly.groups.size());
}

// Whether the chain of parents ends at the root.
bool ReachesRoot(const Assembly& assembly, int group) {
  for (std::size_t steps = 0; steps <= assembly.groups.size(); ++steps) {
    if (group == 0) return true;
    if (!IsGroup(assembly, group)) return false;
    group = assembly.groups[static_cast<std::size_t>(group)].parent;
  }
  return false;
}

void CheckGroups(const Assembly& assembly, Findings& findings) {
  if (assembly.groups.empty()) {
    findings.push_back({"groups", "there must be a root group"});
    return;
  }
  if (assembly.groups[0].parent != -1) {
    findings.push_back({"groups[0].parent", "the first group is the root and has no parent"});
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < assembly.groups.size(); ++i) {
    const AssemblyGroup& group = assembly.groups[i];
    const std::string place = absl::StrCat("groups[", i, "]");
    if (group.name.empty()) findings.push_back({place + ".name", "must not be empty"});
    if (!names.insert(group.name).second) {
      findings.push_back({place + ".name", absl::StrCat("'", group.name, "' occurs twice")});
    }
    if (i > 0 && !ReachesRoot(assembly, static_cast<int>(i))) {
      findings.push_back({place + ".parent", "the hierarchy does not lead to the root"});
    }
  }
}

void CheckBox(const std::string& place, const BoundingBox& box, Findings& findings) {
  if (!box.minimum.allFinite() || !box.maximum.allFinite()) {
    findings.push_back({place + ".box", "must be finite"});
  } else if (std::max(box.minimum.cwiseAbs().maxCoeff(), box.maximum.cwiseAbs().maxCoeff()) >
             kMaxFromOrigin) {
    findings.push_back(
        {place + ".box", absl::StrCat("must lie within ", kMaxFromOrigin, " m of the origin")});
  } else if ((box.size().array() < kMinPart - kLimitTolerance).any()) {
    findings.push_back({place + ".box", "must measure at least 1 µm along each axis"});
  }
}

// Along axes on which the box is finite; of others, the box is a finding.
void CheckLimits(const std::string& place, const AssemblyPart& part, Findings& findings) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(part.box.size()[axis])) continue;
    const SizeLimits& limits = part.limits[static_cast<std::size_t>(axis)];
    const std::string field = absl::StrCat(place, ".limits.", AxisName(static_cast<Axis>(axis)));
    if (!(limits.minimum > 0) || !std::isfinite(limits.maximum)) {
      findings.push_back({field, "must be finite and greater than 0"});
    } else if (limits.minimum > limits.maximum) {
      findings.push_back({field, "the minimum is above the maximum"});
    } else if (const double size = part.box.size()[axis];
               size < limits.minimum - kLimitTolerance || size > limits.maximum + kLimitTolerance) {
      findings.push_back({field, absl::StrCat("the part measures ", size, " m, its item allows ",
                                              limits.minimum, " to ", limits.maximum, " m")});
    }
  }
}

// A plane may lie outside its part, as a hinge's axis does, but not far from it: what is a slip of
// the pen would hold parts in line that have nothing to do with each other.
void CheckPlanes(const std::string& place, const AssemblyPart& part, Findings& findings) {
  const double furthest = part.box.size().maxCoeff() + kLimitTolerance;
  for (std::size_t i = 0; i < part.prominent_planes.size(); ++i) {
    const ProminentPlane& plane = part.prominent_planes[i];
    const std::string field = absl::StrCat(place, ".prominent_planes[", i, "].position");
    const auto axis = static_cast<Eigen::Index>(plane.axis);
    const double outside =
        std::max(part.box.minimum[axis] - plane.position, plane.position - part.box.maximum[axis]);
    if (!(std::abs(plane.position) <= kMaxFromOrigin)) {
      findings.push_back(
          {field, absl::StrCat("must lie within ", kMaxFromOrigin, " m of the origin")});
    } else if (outside > furthest) {
      findings.push_back(
          {field, absl::StrCat("lies ", outside, " m outside the part's box, which is ",
                               part.box.size().maxCoeff(),
                               " m at its largest: at "
                               "most as far is allowed")});
    }
  }
}

void CheckParts(const Assembly& assembly, Findings& findings) {
  if (assembly.parts.empty()) findings.push_back({"parts", "there must be a part"});
  std::set<std::string> names;
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    const AssemblyPart& part = assembly.parts[i];
    const std::string place = absl::StrCat("parts[", i, "]");
    if (part.name.empty()) findings.push_back({place + ".name", "must not be empty"});
    if (!names.insert(part.name).second) {
      findings.push_back({place + ".name", absl::StrCat("'", part.name, "' occurs twice")});
    }
    if (!IsGroup(assembly, part.group)) findings.push_back({place + ".group", "is no group"});
    const std::size_t before = findings.size();
    CheckBox(place, part.box, findings);
    const bool box_usable = findings.size() == before;
    if (box_usable || !part.box.size().allFinite()) CheckLimits(place, part, findings);
    if (box_usable) CheckPlanes(place, part, findings);
  }
}

// The motion of a rest pose, measured the way the joint's limits are.
double Amount(const Joint& joint, const RestPose& pose) {
  return joint.kind == JointKind::kBall ? pose.motion.norm() : pose.motion.dot(joint.axis);
}

// `limits_usable`, `axis_usable`: else nothing is said that follows from them.
void CheckRestPose(const std::string& place, const Joint& joint, const RestPose& pose,
                   bool limits_usable, bool axis_usable, Findings& findings) {
  if (!pose.motion.allFinite()) {
    findings.push_back({place, "must be finite"});
    return;
  }
  if (!axis_usable) return;
  const double amount = Amount(joint, pose);
  if (joint.kind != JointKind::kBall &&
      (pose.motion - amount * joint.axis).norm() > kLimitTolerance) {
    findings.push_back({place, "moves out of the joint's axis"});
  }
  if (limits_usable &&
      (amount < joint.lower - kLimitTolerance || amount > joint.upper + kLimitTolerance)) {
    findings.push_back({place, absl::StrCat("'", pose.name, "' is beyond the joint's limits")});
  }
}

bool HasParts(const Assembly& assembly, int group) {
  return std::any_of(assembly.parts.begin(), assembly.parts.end(), [&](const AssemblyPart& part) {
    return IsGroup(assembly, part.group) && IsWithin(assembly, part.group, group);
  });
}

// What lies beyond has lost so many digits that nothing can be said of it; a ball that is turned
// further than half way round is turned the other way.
std::pair<double, double> FurthestLimits(JointKind kind) {
  switch (kind) {
    case JointKind::kPrismatic:
      return {-kMaxFromOrigin, kMaxFromOrigin};
    case JointKind::kBall:
      return {0, kHalfTurn};
    default:
      return {-kMaxTurn, kMaxTurn};
  }
}

bool HasUsableLimits(const Joint& joint, const std::string& place, Findings& findings) {
  const auto [least, most] = FurthestLimits(joint.kind);
  const char* const unit = joint.kind == JointKind::kPrismatic ? " m" : " rad";
  const std::size_t before = findings.size();
  for (const auto& [field, limit] :
       {std::pair(".lower", joint.lower), std::pair(".upper", joint.upper)}) {
    if (limit >= least && limit <= most) continue;
    findings.push_back(
        {place + field, absl::StrCat("must lie between ", least, " and ", most, unit)});
  }
  if (findings.size() == before && joint.lower > joint.upper) {
    findings.push_back({place + ".lower", "is above `upper`"});
  }
  return findings.size() == before;
}

// groups_fault_free: whether each group's parents lead to the root.
void CheckJoints(const Assembly& assembly, bool groups_fault_free, Findings& findings) {
  std::set<int> moved;
  for (std::size_t i = 0; i < assembly.joints.size(); ++i) {
    const Joint& joint = assembly.joints[i];
    const std::string place = absl::StrCat("joints[", i, "]");
    if (!IsGroup(assembly, joint.group) || joint.group == 0) {
      findings.push_back({place + ".group", "must be a group below the root"});
    } else if (!moved.insert(joint.group).second) {
      findings.push_back({place + ".group", "another joint moves this group already"});
    }
    if (!(joint.center.array().abs() <= kMaxFromOrigin).all()) {
      findings.push_back({place + ".center",
                          absl::StrCat("must lie within ", kMaxFromOrigin, " m of the origin")});
    }
    const bool axis_usable = std::abs(joint.axis.norm() - 1) <= kUnitTolerance;
    if (!axis_usable) findings.push_back({place + ".axis", "must be a unit vector"});
    const bool limits_usable = HasUsableLimits(joint, place, findings);
    if (limits_usable && (joint.lower > kLimitTolerance || joint.upper < -kLimitTolerance)) {
      findings.push_back(
          {place + ".lower", "the limits must include 0, the pose in which the design is drawn"});
    }
    if (IsGroup(assembly, joint.group) && groups_fault_free && !assembly.parts.empty() &&
        !HasParts(assembly, joint.group)) {
      findings.push_back({place + ".group", "there are no parts in the group that it moves"});
    }
    for (std::size_t j = 0; j < joint.rest_poses.size(); ++j) {
      CheckRestPose(absl::StrCat(place, ".rest_poses[", j, "]"), joint, joint.rest_poses[j],
                    limits_usable, axis_usable, findings);
    }
  }
}

// Whether parts in one place must overlap: solids of two shapes may share a box and yet only touch.
bool FillTheSame(const AssemblyPart& a, const AssemblyPart& b) {
  if (a.shape == nullptr || b.shape == nullptr || a.shape == b.shape) return true;
  return a.shape->name == b.shape->name && a.shape->turn == b.shape->turn;
}

void CheckPlaces(const Assembly& assembly, Findings& findings) {
  std::map<std::array<long, 6>, std::vector<std::size_t>> parts_at;
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    const AssemblyPart& part = assembly.parts[i];
    if (!part.box.minimum.allFinite() || !part.box.maximum.allFinite()) continue;
    std::array<long, 6> place;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto along = static_cast<Eigen::Index>(axis);
      place[axis] = std::lround(part.box.minimum[along] / kSamePlace);
      place[axis + 3] = std::lround(part.box.maximum[along] / kSamePlace);
    }
    std::vector<std::size_t>& there = parts_at[place];
    for (const std::size_t other : there) {
      if (!FillTheSame(assembly.parts[other], part)) continue;
      findings.push_back(
          {absl::StrCat("parts[", i, "].position"),
           absl::StrCat("lies in the same place as '", assembly.parts[other].name, "'")});
      break;
    }
    there.push_back(i);
  }
}

}  // namespace

std::vector<FieldViolation> ValidateAssembly(const Assembly& assembly) {
  Findings findings;
  CheckGroups(assembly, findings);
  const bool groups_fault_free = findings.empty();
  CheckParts(assembly, findings);
  CheckPlaces(assembly, findings);
  CheckJoints(assembly, groups_fault_free, findings);
  return findings;
}

int GroupDepth(const Assembly& assembly, int group) {
  int depth = 0;
  for (; group != 0; group = assembly.groups[static_cast<std::size_t>(group)].parent) ++depth;
  return depth;
}

int LowestCommonGroup(const Assembly& assembly, int a, int b) {
  const auto parent = [&](int group) {
    return assembly.groups[static_cast<std::size_t>(group)].parent;
  };
  int depth_a = GroupDepth(assembly, a);
  int depth_b = GroupDepth(assembly, b);
  while (a != b) {
    if (depth_a >= depth_b) {
      a = parent(a);
      --depth_a;
    } else {
      b = parent(b);
      --depth_b;
    }
  }
  return a;
}

bool IsWithin(const Assembly& assembly, int group, int ancestor) {
  while (group != ancestor && group != 0) {
    group = assembly.groups[static_cast<std::size_t>(group)].parent;
  }
  return group == ancestor;
}

double AssemblyDiagonal(const Assembly& assembly) {
  Eigen::Vector3d minimum = assembly.parts.front().box.minimum;
  Eigen::Vector3d maximum = assembly.parts.front().box.maximum;
  for (const AssemblyPart& part : assembly.parts) {
    minimum = minimum.cwiseMin(part.box.minimum);
    maximum = maximum.cwiseMax(part.box.maximum);
  }
  return (maximum - minimum).norm();
}

double ToleranceOf(const Assembly& assembly) { return 1e-6 * AssemblyDiagonal(assembly); }

}  // namespace mortise::parametric
