#include "services/composer/connecting/component_motion.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"

namespace mortise::composer {
namespace {

using parametric::ConnectionPatch;
using parametric::ElementConnection;
using parametric::Joint;

constexpr double kSamePlace = 1e-3;  // m, of the axes of one motion

bool HasParts(const CollectionConnection& connection) {
  return !connection.connection.connecting.empty();
}

std::set<std::string> NamesOf(const std::vector<PrincipalPart>& component) {
  std::set<std::string> names;
  for (const PrincipalPart& part : component) names.insert(part.drawn_as);
  return names;
}

// Which principals of a connection of the original are the component's; none where it is not
// between the component and the rest.
std::vector<bool> InsideOf(const CollectionConnection& connection,
                           const std::set<std::string>& own) {
  std::vector<bool> inside;
  for (const std::string& name : connection.Principals()) inside.push_back(own.contains(name));
  const auto count = std::count(inside.begin(), inside.end(), true);
  if (count == 0 || count == static_cast<std::ptrdiff_t>(inside.size())) inside.clear();
  return inside;
}

// Whether a joint of a connection moves those of its principals that are inside against all others.
bool Separates(const ElementConnection& connection, const Joint& joint,
               const std::vector<bool>& inside) {
  bool moves_inside = true, moves_outside = true;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    const bool moves =
        parametric::IsWithin(connection.assembly, connection.elements[i].group, joint.group);
    moves_inside = moves_inside && moves == inside[i];
    moves_outside = moves_outside && moves != inside[i];
  }
  return moves_inside || moves_outside;
}

// Notes in which way the contacts of a connection keep on their way those of its principals that
// are inside. `box_of` says where a principal is.
template <typename BoxOf>
void AddContacts(const std::vector<ConnectionPatch>& patches, const std::vector<bool>& inside,
                 const Joint& joint, const BoxOf& box_of, Guidance& guidance) {
  for (const ConnectionPatch& patch : patches) {
    const bool first = inside[static_cast<std::size_t>(patch.first)];
    if (patch.kind != parametric::PatchKind::kContact ||
        first == inside[static_cast<std::size_t>(patch.second)]) {
      continue;
    }
    guidance.AddContact(joint, box_of(first ? patch.first : patch.second),
                        box_of(first ? patch.second : patch.first), patch.normal);
  }
}

std::vector<bool> InsideOf(const Candidate& candidate) {
  std::vector<bool> inside;
  for (const BoundPrincipal& bound : candidate.principals) inside.push_back(bound.of_component);
  return inside;
}

}  // namespace

ComponentMotion::ComponentMotion(const BothSides& sides, const std::string& name,
                                 const Original* original, ItemKindOf kind_of)
    : original_(original), kind_of_(std::move(kind_of)), frames_(sides) {
  if (original == nullptr) {
    wanted_ = WantedMotionOf(sides.component_parts, name, nullptr);
    return;
  }
  own_joint_ = OwnJointOf(original->design.assembly->assembly(), sides.component_parts);
  // What its design holds firmly stays so, whatever it is called.
  if (own_joint_ == nullptr && IsFastenedIn(*original, sides.component_parts)) return;
  wanted_ = WantedMotionOf(sides.component_parts, name, own_joint_);
  if (own_joint_ != nullptr) wanted_guidance_ = GuidanceIn(*original, sides.component_parts);
}

// What moves is not fastened by what lets it move, nor by what its joint moves it against.
bool ComponentMotion::IsFastenedIn(const Original& original,
                                   const std::vector<PrincipalPart>& component) const {
  const std::set<std::string> own = NamesOf(component);
  return std::any_of(
      original.connections->begin(), original.connections->end(),
      [&](const CollectionConnection& one) {
        const std::vector<bool> inside = InsideOf(one, own);
        if (inside.empty() || !HasParts(one) || IsMadeToMove(one.connection, kind_of_))
          return false;
        const auto& joints = one.connection.assembly.joints;
        return std::none_of(joints.begin(), joints.end(), [&](const Joint& joint) {
          return Separates(one.connection, joint, inside);
        });
      });
}

Guidance ComponentMotion::GuidanceIn(const Original& original,
                                     const std::vector<PrincipalPart>& component) const {
  const std::set<std::string> own = NamesOf(component);
  Guidance guidance;
  for (const CollectionConnection& one : *original.connections) {
    const std::vector<bool> inside = InsideOf(one, own);
    if (inside.empty()) continue;
    if (HasParts(one)) {
      if (Guides(one.connection, *own_joint_, kind_of_)) return {};
      continue;
    }
    const auto box_of = [&](int principal) {
      return one.connection.elements[static_cast<std::size_t>(principal)].box;
    };
    AddContacts(one.connection.patches, inside, *own_joint_, box_of, guidance);
  }
  return guidance;
}

bool ComponentMotion::HasGuides(const Candidate& candidate) const {
  const std::optional<int> joint = JointOfComponent(candidate);
  const ElementConnection& connection = candidate.from->connection;
  return joint &&
         Guides(connection, connection.assembly.joints[static_cast<std::size_t>(*joint)], kind_of_);
}

bool ComponentMotion::HasOnlyHardware(const Candidate& candidate) const {
  return !JointOfComponent(candidate) && IsMadeToMove(candidate.from->connection, kind_of_);
}

bool ComponentMotion::IsContactOnWay(const Candidate& candidate) const {
  if (!wanted_guidance_.Keeps() || HasParts(*candidate.from)) return false;
  if (candidate.from->source != original_->source || !JointOfComponent(candidate)) return false;
  const auto& patches = candidate.from->connection.patches;
  return std::any_of(patches.begin(), patches.end(), [&](const ConnectionPatch& patch) {
    return Guidance::IsOfWay(*own_joint_, patch.normal);
  });
}

std::string ComponentMotion::WhyNotHeld(const Candidate& candidate, const BothSides& sides) const {
  if (!HasParts(*candidate.from)) return "";
  if (const auto pair = frames_.FirstConflict(HeldPairs(candidate))) {
    return absl::StrCat("it would hold '", sides.PartOf({true, pair->second}).name, "' fast to '",
                        sides.PartOf({false, pair->first}).name,
                        "', though joints move what it is held to against that");
  }
  if (!wanted_.moves || HasGuides(candidate)) return "";
  if (!JointOfComponent(candidate)) {
    return HasOnlyHardware(candidate) ? "" : "it would hold fast what is to move";
  }
  // What its design has besides, as a catch is, comes along.
  const bool is_own = original_ != nullptr && candidate.from->source == original_->source;
  return is_own ? "" : "nothing of it lets that move";
}

std::string ComponentMotion::WhyNotMoved(const Candidate& candidate,
                                         const parametric::OptimizedConnection& placed) const {
  if (!wanted_.moves || !HasGuides(candidate)) return "";
  const Joint made = JointWhere(candidate, placed, *JointOfComponent(candidate));
  std::optional<Joint> known = joint_;
  if (!known && own_joint_ != nullptr) {
    known = *own_joint_;
    known->center = made.center;  // the component is elsewhere now
  }
  if (!known || MoveAlike(made, *known, kSamePlace)) return "";
  return "it would let it move in another way";
}

bool ComponentMotion::BringsJoint(const Candidate& candidate) const {
  return HasParts(*candidate.from) ? HasGuides(candidate)
                                   : joint_ && contact_joint_ && IsContactOnWay(candidate);
}

void ComponentMotion::Take(const Candidate& candidate,
                           const parametric::OptimizedConnection& placed) {
  for (const PartPair& pair : HeldPairs(candidate)) frames_.Fasten(pair.first, pair.second);
  has_own_hardware_ = has_own_hardware_ || (wanted_.moves && HasOnlyHardware(candidate));
  if (joint_) return;
  const std::optional<int> joint = JointOfComponent(candidate);
  if (HasGuides(candidate)) joint_ = JointWhere(candidate, placed, *joint);
  if (!IsContactOnWay(candidate)) return;
  const Joint made = JointWhere(candidate, placed, *joint);
  const auto box_of = [&](int principal) { return parametric::BoxOf(placed.q, principal); };
  AddContacts(placed.patches, InsideOf(candidate), made, box_of, guidance_);
  if (!contact_joint_) contact_joint_ = made;
  if (guidance_.Covers(wanted_guidance_)) joint_ = contact_joint_;
}

}  // namespace mortise::composer
