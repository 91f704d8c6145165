#include "services/composer/holding/joint_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {
namespace {

using parametric::ItemKind;

constexpr double kTouches = 2e-4;   // m, between boxes
constexpr double kRounding = 1e-3;  // diameters
constexpr char kOwn[] = "our own rule of thumb";

// The name that the parts of a row share: "slat" of "slat 3". So what is found of one is told once.
std::string RowName(const std::string& part) {
  const std::size_t end = part.find_last_not_of("0123456789.");
  if (end == std::string::npos || end + 1 == part.size() || part[end] != ' ') return part;
  return part.substr(0, end);
}

// A length in diameters as text: halves of a tenth go up, whatever their last bit.
std::string Diameters(double found) { return absl::StrFormat("%.1f d", found + 1e-9); }

class JointJudge {
 public:
  JointJudge(const JointRules& rules, std::vector<Finding>& findings)
      : rules_(rules), findings_(findings) {}

  void Judge(const Joint& joint) {
    for (const Fastener& fastener : joint.fasteners) {
      if (!fastener.IsPin()) {
        JudgeHardware(joint, fastener);
        continue;
      }
      if (!(fastener.diameter > 0)) continue;
      for (const JoinedPart& part : joint.principals) JudgeEdges(fastener, part);
      if (fastener.kind == FastenerKind::kScrew) JudgeScrewDepth(joint, fastener);
      if (fastener.kind == FastenerKind::kDowel) JudgeDowelDepth(joint, fastener);
    }
    JudgeSpacing(joint);
  }

 private:
  struct Limit {
    Severity severity;
    double wanted;
    const char* source;
  };

  void Add(const Limit& limit, const char* rule, const std::string& part, double found,
           const std::string& unit, const std::string& text) {
    findings_.push_back(
        {limit.severity, rule, {part}, found, limit.wanted, unit, text, limit.source});
  }

  // The limits of an edge distance, the gravest first.
  std::vector<Limit> EdgeLimits(const Fastener& pin, const JoinedPart& part) const {
    std::vector<Limit> limits{{Severity::kFault, 0.5, "half its diameter: it comes out"}};
    if (part.is_metal) {
      limits.push_back({Severity::kWarning, rules_.metal_edge, "EN 1993-1-8, Table 3.3"});
    } else if (pin.kind == FastenerKind::kDowel) {
      limits.push_back({Severity::kWarning, rules_.dowel_edge, kOwn});
    } else {
      limits.push_back({Severity::kWarning, rules_.screw_edge_least, kOwn});
      limits.push_back(
          {Severity::kNotice, rules_.screw_edge, "EN 1995-1-1, Table 8.2, bored, unloaded edge"});
    }
    return limits;
  }

  void JudgeEdges(const Fastener& pin, const JoinedPart& part) {
    if (!part.is_box || IsAtASlant(pin) || DepthIn(pin, part) <= kMaxOverlap) return;
    double distance = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == pin.axis) continue;
      const double at = pin.box.center()[axis];
      distance = std::min({distance, at - part.box.minimum[axis], part.box.maximum[axis] - at});
    }
    const double found = distance / pin.diameter;
    for (const Limit& limit : EdgeLimits(pin, part)) {
      if (found >= limit.wanted - kRounding) continue;
      Add(limit, "edge-distance", pin.name, found, "d",
          absl::StrFormat("%.1f mm (%s) from a face of '%s' beside it; %s wanted", 1000 * distance,
                          Diameters(found), RowName(part.name), Diameters(limit.wanted)));
      return;
    }
  }

  // A box that is not as thick as the pin is that of one at a slant, or of a head.
  static bool IsAtASlant(const Fastener& pin) {
    for (int axis = 0; axis < 3; ++axis) {
      if (axis != pin.axis && pin.box.size()[axis] > 3 * pin.diameter) return true;
    }
    return false;
  }

  // The part that a screw ends in, deeper than in any other where both of its ends are hidden.
  static const JoinedPart* EndsIn(const Joint& joint, const Fastener& pin) {
    const JoinedPart* found = nullptr;
    for (const JoinedPart& part : joint.principals) {
      if (DepthIn(pin, part) <= kMaxOverlap) continue;
      const int a = pin.axis;
      const bool from_below = pin.box.minimum[a] < part.box.minimum[a] - kMaxOverlap &&
                              pin.box.maximum[a] < part.box.maximum[a] - kMaxOverlap;
      const bool from_above = pin.box.maximum[a] > part.box.maximum[a] + kMaxOverlap &&
                              pin.box.minimum[a] > part.box.minimum[a] + kMaxOverlap;
      if (!from_below && !from_above) continue;
      if (found == nullptr || DepthIn(pin, part) > DepthIn(pin, *found)) found = &part;
    }
    return found;
  }

  void JudgeScrewDepth(const Joint& joint, const Fastener& pin) {
    const JoinedPart* const part = EndsIn(joint, pin);
    if (part == nullptr || part->is_metal || IsAtASlant(pin)) return;
    const double found = DepthIn(pin, *part) / pin.diameter;
    const Limit limits[] = {{Severity::kWarning, rules_.screw_depth_least, kOwn},
                            {Severity::kNotice, rules_.screw_depth, "EN 1995-1-1, 8.7.2"}};
    for (const Limit& limit : limits) {
      if (found >= limit.wanted - kRounding) continue;
      Add(limit, "thread-depth", pin.name, found, "d",
          absl::StrFormat("%.1f mm (%s) deep in '%s'; %s wanted", found * 1000 * pin.diameter,
                          Diameters(found), RowName(part->name), Diameters(limit.wanted)));
      return;
    }
  }

  void JudgeDowelDepth(const Joint& joint, const Fastener& pin) {
    for (const JoinedPart& part : joint.principals) {
      const double depth = DepthIn(pin, part);
      if (depth <= kMaxOverlap || depth >= (rules_.dowel_depth - kRounding) * pin.diameter)
        continue;
      Add({Severity::kWarning, rules_.dowel_depth, kOwn}, "dowel-depth", pin.name,
          depth / pin.diameter, "d",
          absl::StrFormat("%.1f mm (%s) deep in '%s'; %s wanted", 1000 * depth,
                          Diameters(depth / pin.diameter), RowName(part.name),
                          Diameters(rules_.dowel_depth)));
    }
  }

  void JudgeHardware(const Joint& joint, const Fastener& hardware) {
    if (hardware.item_kind != ItemKind::kBracket && hardware.item_kind != ItemKind::kHinge &&
        hardware.item_kind != ItemKind::kDrawerSlide) {
      return;
    }
    for (const JoinedPart& part : joint.principals) {
      if (CommonDepth(hardware.box, part.box) < -kTouches) continue;
      const auto holds = [&](const Fastener& pin) {
        return pin.IsPin() && DepthIn(pin, part) > kMaxOverlap &&
               CommonDepth(pin.box, hardware.box) >= -kTouches;
      };
      if (std::any_of(joint.fasteners.begin(), joint.fasteners.end(), holds)) continue;
      Add({Severity::kWarning, 1, kOwn}, "bracket-not-fastened", hardware.name, 0, "1",
          absl::StrCat("no screw, bolt or dowel into '", part.name, "', which it lies against"));
    }
  }

  void JudgeSpacing(const Joint& joint) {
    if (joint.fasteners.empty() || joint.principals.size() != 2 || joint.moves) return;
    const double wanted = std::ceil(joint.length / rules_.fastener_spacing - kRounding);
    const auto found = static_cast<double>(joint.fasteners.size());
    if (found >= wanted) return;
    Finding finding{Severity::kNotice,
                    "fastener-spacing",
                    {},
                    found,
                    wanted,
                    "1",
                    absl::StrFormat("%.2f m of contact and %.0f fasteners; %.0f wanted, one every "
                                    "%.1f m",
                                    joint.length, found, wanted, rules_.fastener_spacing),
                    kOwn};
    for (const JoinedPart& part : joint.principals) finding.parts.push_back(part.name);
    findings_.push_back(std::move(finding));
  }

  const JointRules& rules_;
  std::vector<Finding>& findings_;
};

}  // namespace

std::vector<Finding> JudgeJoints(const std::vector<Joint>& joints, const JointRules& rules) {
  std::vector<Finding> findings;
  JointJudge judge(rules, findings);
  for (const Joint& joint : joints) judge.Judge(joint);
  return findings;
}

}  // namespace mortise::composer
