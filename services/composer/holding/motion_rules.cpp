#include "services/composer/holding/motion_rules.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "services/composer/connecting/motions.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::JointKind;
using Names = std::set<std::string>;

constexpr double kTouches = 2e-4;       // m, between boxes
constexpr double kParallel = 1 - 1e-4;  // cosine
constexpr std::size_t kMostNamed = 3;
constexpr char kOwn[] = "our own rule of thumb";

// The principal parts of a group, and of all below it.
Names PrincipalsIn(const Assembly& assembly, int group) {
  Names names;
  for (const parametric::AssemblyPart& part : assembly.parts) {
    if (!part.connecting && parametric::IsWithin(assembly, part.group, group)) {
      names.insert(part.name);
    }
  }
  return names;
}

// Whether a pin lets a joint move what is on it.
bool LetsMove(const parametric::Joint& joint, const Fastener& pin) {
  const Eigen::Index axis = pin.axis;
  const bool is_along = std::abs(joint.axis[axis]) >= kParallel;
  if (joint.kind == JointKind::kPrismatic) return is_along && pin.kind != FastenerKind::kScrew;
  if (joint.kind == JointKind::kHinge && !is_along) return false;
  Eigen::Vector3d apart = pin.box.center() - joint.center;
  apart[axis] = 0;
  return apart.norm() <= pin.diameter;
}

// Whether a fastener lets what it goes into move, or is right to hold it.
using MayHold = std::function<bool(const Fastener& fastener, const std::string& part)>;

// What is fastened to others.
struct HeldFast {
  Names parts, others, fasteners;
};

class FastJudge {
 public:
  // `lets_move` says which pins do, `may_hold` which fasteners may hold fast a part that is moved.
  FastJudge(const Names& moved, std::function<bool(const Fastener&)> lets_move, MayHold may_hold)
      : moved_(moved), lets_move_(std::move(lets_move)), may_hold_(std::move(may_hold)) {}

  HeldFast In(const std::vector<Joint>& joints) {
    for (const Joint& joint : joints) {
      for (const Fastener& fastener : joint.fasteners) {
        if (fastener.IsPin()) {
          Take(fastener, Reached(joint, fastener));
        } else if (fastener.item_kind == parametric::ItemKind::kBracket) {
          Take(fastener, FastenedTo(joint, fastener));
        }
      }
    }
    return std::move(held_);
  }

 private:
  // What a pin goes into that cannot move on it.
  Names Reached(const Joint& joint, const Fastener& pin) const {
    Names reached;
    if (lets_move_(pin)) return reached;
    for (const JoinedPart& part : joint.principals) {
      if (DepthIn(pin, part) > kMaxOverlap) reached.insert(part.name);
    }
    return reached;
  }

  Names FastenedTo(const Joint& joint, const Fastener& bracket) const {
    Names fastened;
    for (const Fastener& pin : joint.fasteners) {
      if (!pin.IsPin() || CommonDepth(pin.box, bracket.box) < -kTouches) continue;
      fastened.merge(Reached(joint, pin));
    }
    return fastened;
  }

  void Take(const Fastener& fastener, const Names& reached) {
    Names parts, others;
    for (const std::string& name : reached) {
      if (!moved_.contains(name)) {
        others.insert(name);
      } else if (!may_hold_(fastener, name)) {
        parts.insert(name);
      }
    }
    if (parts.empty() || others.empty()) return;
    held_.fasteners.insert(fastener.name);
    held_.parts.merge(parts);
    held_.others.merge(others);
  }

  const Names& moved_;
  const std::function<bool(const Fastener&)> lets_move_;
  const MayHold may_hold_;
  HeldFast held_;
};

std::string Listed(const Names& names) {
  std::string listed;
  std::size_t count = 0;
  for (const std::string& name : names) {
    if (count++ == kMostNamed) break;
    absl::StrAppend(&listed, listed.empty() ? "'" : ", '", name, "'");
  }
  if (names.size() > kMostNamed)
    absl::StrAppend(&listed, " and ", names.size() - kMostNamed, " more");
  return listed;
}

// `what` it is to do, and by what that is known.
void Add(Severity severity, const char* rule, const std::string& what, const HeldFast& held,
         std::vector<Finding>& findings) {
  Finding finding{severity, rule, {held.parts.begin(), held.parts.end()}, 0, 0, "1", "", kOwn};
  finding.found = static_cast<double>(held.fasteners.size());
  finding.text = absl::StrCat(
      Listed(held.parts), held.parts.size() == 1 ? " is to " : " are to ", what, ", but ",
      Listed(held.fasteners), held.fasteners.size() == 1 ? " holds " : " hold ",
      held.parts.size() == 1 ? "it" : "them", " fast to ", Listed(held.others));
  findings.push_back(std::move(finding));
}

const char* VerbOf(JointKind kind) { return kind == JointKind::kPrismatic ? "slide" : "turn"; }

// Whether a joint moves a group as a whole.
bool MovesWith(const Assembly& assembly, int group) {
  return std::any_of(assembly.joints.begin(), assembly.joints.end(), [&](const auto& joint) {
    return parametric::IsWithin(assembly, group, joint.group);
  });
}

// Whether a joint moves a group, or something in it.
bool IsMoved(const Assembly& assembly, int group) {
  return MovesWith(assembly, group) ||
         std::any_of(assembly.joints.begin(), assembly.joints.end(), [&](const auto& joint) {
           return parametric::IsWithin(assembly, joint.group, group);
         });
}

// Whether it is the design of a part itself that fastens it.
bool IsByDesign(const DesignOf& design_of, const Fastener& fastener, const std::string& part) {
  if (!design_of) return false;
  const std::string design = design_of(part);
  return !design.empty() && design_of(fastener.name) == design;
}

void JudgeNamed(const std::string& name, const Names& parts, const std::vector<Joint>& joints,
                const DesignOf& design_of, std::vector<Finding>& findings) {
  const HeldFast held = FastJudge(
                            parts, [](const Fastener&) { return false; },
                            [&](const Fastener& fastener, const std::string& part) {
                              return IsByDesign(design_of, fastener, part);
                            })
                            .In(joints);
  if (held.parts.empty()) return;
  const bool is_part = held.parts.size() == 1 && held.parts.contains(name);
  Add(Severity::kWarning, kCannotMove,
      absl::StrCat("move by ", is_part ? "its name" : absl::StrCat("the name of '", name, "'"),
                   ", and no joint lets ", held.parts.size() == 1 ? "it" : "them"),
      held, findings);
}

}  // namespace

DesignOf OfRedrawn(const Redrawn& redrawn, const DesignOf& design_of) {
  if (!design_of) return nullptr;
  std::map<std::string, std::string> drawn_as;
  for (std::size_t i = 0; i < redrawn.drawn_as.size(); ++i) {
    drawn_as[redrawn.assembly.parts[i].name] = redrawn.drawn_as[i];
  }
  return [drawn_as = std::move(drawn_as), &design_of](const std::string& part) {
    const auto found = drawn_as.find(part);
    return found == drawn_as.end() ? std::string() : design_of(found->second);
  };
}

std::vector<Finding> JudgeMotion(const Assembly& drawn, const std::vector<Joint>& joints,
                                 const DesignOf& design_of) {
  std::vector<Finding> findings;
  for (const parametric::Joint& joint : drawn.joints) {
    const Names moved = PrincipalsIn(drawn, joint.group);
    const HeldFast held = FastJudge(
                              moved, [&](const Fastener& pin) { return LetsMove(joint, pin); },
                              [](const Fastener&, const std::string&) { return false; })
                              .In(joints);
    if (held.parts.empty()) continue;
    Add(Severity::kFault, kScrewedFast, absl::StrCat(VerbOf(joint.kind), " by '", joint.name, "'"),
        held, findings);
  }
  std::set<int> named;  // groups, of which the parts need not be looked at
  for (int group = 1; group < static_cast<int>(drawn.groups.size()); ++group) {
    const parametric::AssemblyGroup& its = drawn.groups[static_cast<std::size_t>(group)];
    if (!IsMeantToMove(its.name) || IsMoved(drawn, group)) continue;
    named.insert(group);
    JudgeNamed(its.name, PrincipalsIn(drawn, group), joints, design_of, findings);
  }
  for (const parametric::AssemblyPart& part : drawn.parts) {
    if (part.connecting || !IsMeantToMove(part.name) || MovesWith(drawn, part.group)) continue;
    const bool is_in_named = std::any_of(named.begin(), named.end(), [&](int group) {
      return parametric::IsWithin(drawn, part.group, group);
    });
    if (!is_in_named) JudgeNamed(part.name, {part.name}, joints, design_of, findings);
  }
  return findings;
}

}  // namespace mortise::composer
