#include "services/composer/connecting/component_motion.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace mortise::composer {
namespace {

constexpr double kSamePlace = 1e-3;  // m, of the axes of one motion

bool HasParts(const CollectionConnection& connection) {
  return !connection.connection.connecting.empty();
}

// Whether fasteners hold the component to the rest of its original design.
bool IsFastenedIn(const Original& original, const std::vector<PrincipalPart>& component) {
  std::set<std::string> own;
  for (const PrincipalPart& part : component) own.insert(part.drawn_as);
  return std::any_of(original.connections.begin(), original.connections.end(),
                     [&](const CollectionConnection& one) {
                       if (!HasParts(one)) return false;
                       const std::vector<std::string> names = one.Principals();
                       const auto inside = std::count_if(
                           names.begin(), names.end(),
                           [&](const std::string& name) { return own.contains(name); });
                       return inside > 0 && inside < static_cast<std::ptrdiff_t>(names.size());
                     });
}

}  // namespace

ComponentMotion::ComponentMotion(const BothSides& sides, const std::string& name,
                                 const Original* original)
    : original_(original), frames_(sides) {
  if (original == nullptr) {
    wanted_ = WantedMotionOf(sides.component_parts, name, nullptr);
    return;
  }
  own_joint_ = OwnJointOf(original->design.assembly->assembly(), sides.component_parts);
  const bool is_fastened = IsFastenedIn(*original, sides.component_parts);
  only_touches_ = own_joint_ != nullptr && !is_fastened;
  // What its design holds firmly stays so, whatever it is called.
  if (own_joint_ == nullptr && is_fastened) return;
  wanted_ = WantedMotionOf(sides.component_parts, name, own_joint_);
}

bool ComponentMotion::Differs(const Candidate& candidate,
                              const parametric::OptimizedConnection& placed) const {
  if (!wanted_.moves) return false;
  if (original_ != nullptr && candidate.from->source == original_->source) return false;
  const std::optional<int> joint = JointOfComponent(candidate);
  if (!joint) return false;
  const parametric::Joint made = JointWhere(candidate, placed, *joint);
  if (joint_) return !MoveAlike(made, *joint_, kSamePlace);
  if (own_joint_ == nullptr) return false;
  parametric::Joint own = *own_joint_;
  own.center = made.center;  // the component is elsewhere now
  return !MoveAlike(made, own, kSamePlace);
}

bool ComponentMotion::BringsJoint(const CollectionConnection& connection) const {
  return HasParts(connection) || (only_touches_ && connection.source == original_->source);
}

void ComponentMotion::Take(const Candidate& candidate,
                           const parametric::OptimizedConnection& placed) {
  if (!BringsJoint(*candidate.from)) return;
  const std::optional<int> joint = JointOfComponent(candidate);
  if (joint && !joint_) joint_ = JointWhere(candidate, placed, *joint);
  if (!HasParts(*candidate.from)) return;
  for (const BoundPrincipal& a : candidate.principals) {
    for (const BoundPrincipal& b : candidate.principals) {
      if (!a.of_component && b.of_component) frames_.Fasten(a.part, b.part);
    }
  }
}

}  // namespace mortise::composer
