#include "services/composer/snapping/snap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/element.h"
#include "common/base/errors.h"
#include "services/composer/model/movable_set.h"
#include "services/composer/model/overlap.h"
#include "services/composer/model/placed_forms.h"
#include "services/composer/snapping/alignment_search.h"
#include "services/composer/snapping/clearance.h"
#include "services/composer/snapping/original_constraints.h"
#include "services/composer/snapping/plane.h"
#include "services/composer/snapping/posed_planes.h"
#include "services/composer/snapping/target_planes.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::Demand;
using parametric::FeasibleSet;
using parametric::LinearForm;

constexpr double kDeformed = 1e-4;    // of a size
constexpr double kRestricted = 1e-6;  // of a form, what the set and the constraints leave of it

// Keeps the forms that are linearly independent on a feasible set.
class IndependentForms {
 public:
  explicit IndependentForms(const FeasibleSet& set) : set_(set) {}

  // Whether the form can change with all kept ones held.
  bool IsFree(const LinearForm& form) const { return Rest(form).norm() > kRestricted; }

  void Keep(const LinearForm& form) { frame_.push_back(Rest(form).normalized()); }

 private:
  Eigen::VectorXd Rest(const LinearForm& form) const {
    Eigen::VectorXd rest = Eigen::VectorXd::Zero(set_.degrees_of_freedom());
    for (const parametric::LinearTerm& term : form.terms) {
      rest += term.coefficient * set_.basis().row(term.variable).transpose();
    }
    // Twice is enough for orthogonality to rounding (Kahan).
    for (int pass = 0; pass < 2; ++pass) {
      for (const Eigen::VectorXd& kept : frame_) rest -= kept.dot(rest) * kept;
    }
    return rest;
  }

  const FeasibleSet& set_;
  std::vector<Eigen::VectorXd> frame_;
};

BoundingBox BoundsAround(const std::vector<PrincipalPart>& parts) {
  BoundingBox bounds = parts.front().box;
  for (const PrincipalPart& part : parts) {
    bounds.minimum = bounds.minimum.cwiseMin(part.box.minimum);
    bounds.maximum = bounds.maximum.cwiseMax(part.box.maximum);
  }
  return bounds;
}

// The planes of the component, in the rest poses of its own joints and of those of its original.
std::vector<DesignPlane> ComponentPlanes(const Design& component,
                                         const std::vector<PrincipalPart>& parts,
                                         const Design* original) {
  std::vector<DesignPlane> planes = PlanesOf(component, parts);
  if (original == nullptr) return planes;
  for (DesignPlane& plane : PlanesInPosesOf(*original, component)) {
    planes.push_back(std::move(plane));
  }
  return planes;
}

class Snapper {
 public:
  Snapper(const Design& component, const Design* original, const Design& body,
          const SnapOptions& options)
      : component_(component),
        original_(original),
        body_(body),
        options_(options),
        parts_(PrincipalPartsOf(component)),
        planes_(ComponentPlanes(component, parts_, original)),
        body_parts_(PrincipalPartsOf(body)),
        body_planes_(PlanesOf(body, body_parts_)),
        set_(*component.assembly),
        independent_(set_.feasible()),
        translations_(component.assembly->Translations()),
        wish_(InSpace(component)),
        q_(wish_),
        tolerance_(std::max(body.assembly->tolerance(), component.assembly->tolerance())),
        bounds_(BoundsAround(parts_)),
        targets_({parts_, planes_}, {body_parts_, body_planes_}, options, tolerance_),
        clearance_(component, original, body) {}

  absl::StatusOr<Snapped> Snap() {
    MORTISE_RETURN_IF_ERROR(CheckNear());
    if (original_ != nullptr) {
      MORTISE_RETURN_IF_ERROR(UseOriginal());
    }
    MORTISE_RETURN_IF_ERROR(AlignProminent());
    MORTISE_RETURN_IF_ERROR(KeepSizes());
    Snapped snapped;
    MORTISE_ASSIGN_OR_RETURN(snapped.component, Settled(FromSpace(component_.assembly, q_)));
    snapped.alignments = std::move(alignments_);
    return snapped;
  }

 private:
  absl::Status CheckNear() const {
    const BoundingBox a = BoundsOf(component_);
    const BoundingBox b = BoundsOf(body_);
    const double apart = DistanceBetween(a, b);
    if (apart <= a.size().norm() + b.size().norm()) return absl::OkStatus();
    return PreconditionFailed(
        "SNAP_FAR", absl::StrCat("the component is ", apart,
                                 " m from the model: there is nothing near to align it with"));
  }

  const DesignPlane& PlaneOf(const OriginalConstraint& constraint) const {
    return planes_[static_cast<std::size_t>(constraint.plane)];
  }

  // Contacts that are given up make room for constraints that they implied.
  absl::Status UseOriginal() {
    std::vector<OriginalConstraint> left =
        FindOriginalConstraints(*original_, parts_, planes_, options_.reach);
    targets_.FindAgainst(left);
    while (!left.empty()) {
      const std::vector<OriginalConstraint> constraints = IndependentOf(left);
      MORTISE_ASSIGN_OR_RETURN(const std::set<int> given_up, Choose(constraints));
      if (given_up.empty()) return absl::OkStatus();
      std::erase_if(left, [&](const auto& one) { return given_up.contains(one.plane); });
    }
    return absl::OkStatus();
  }

  // Those that there are planes for, without those that others before them imply.
  std::vector<OriginalConstraint> IndependentOf(
      const std::vector<OriginalConstraint>& constraints) const {
    std::vector<OriginalConstraint> kept;
    IndependentForms independent(set_.feasible());
    for (const OriginalConstraint& one : constraints) {
      const LinearForm& form = PlaneOf(one).position;
      if (!independent.IsFree(form) || targets_.Of(one, 1).empty()) continue;
      independent.Keep(form);
      kept.push_back(one);
    }
    return kept;
  }

  // Finds the combination of planes, and holds what it aligns. Returns the planes of contacts that
  // had to be given up; then nothing is held.
  absl::StatusOr<std::set<int>> Choose(const std::vector<OriginalConstraint>& constraints) {
    const auto count = static_cast<double>(std::max<std::size_t>(constraints.size(), 1));
    const int most = std::clamp(static_cast<int>(std::pow(options_.combinations, 1 / count)), 1,
                                options_.planes);
    std::vector<ChoiceOfPlanes> choices;
    std::vector<std::vector<Target>> targets;
    for (const OriginalConstraint& one : constraints) {
      targets.push_back(targets_.Of(one, most));
      ChoiceOfPlanes& choice = choices.emplace_back();
      choice.form = PlaneOf(one).position;
      for (const Target& target : targets.back()) choice.values.push_back(target.place);
      choice.worth = std::numeric_limits<double>::infinity();
      if (one.is_contact) continue;
      MORTISE_ASSIGN_OR_RETURN(choice.worth, StretchCost(PlaneOf(one).axis));
    }
    Eigen::VectorXd chosen_q = wish_;
    int refused = 0;
    const auto is_admissible = [&](const std::vector<int>& values) -> absl::StatusOr<bool> {
      MORTISE_ASSIGN_OR_RETURN(const std::optional<Eigen::VectorXd> q,
                               Solve(DemandsOf(choices, values)));
      if (q && MayLieAt(*q, constraints, targets, values)) {
        chosen_q = *q;
        return true;
      }
      if (++refused > options_.refusals) return absl::ResourceExhaustedError("refused too often");
      return false;
    };
    const absl::StatusOr<std::optional<ChosenPlanes>> found =
        ChoosePlanes(set_, wish_, choices, is_admissible);
    if (refused > options_.refusals) return std::set<int>{constraints.back().plane};
    MORTISE_RETURN_IF_ERROR(found.status());
    const std::optional<ChosenPlanes>& chosen = *found;
    std::set<int> given_up;
    if (!chosen) return given_up;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      if (chosen->values[i] == kNoPlane && constraints[i].is_contact) {
        given_up.insert(constraints[i].plane);
      }
    }
    if (!given_up.empty()) return given_up;
    q_ = chosen_q;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      if (chosen->values[i] == kNoPlane) continue;
      const Target& target = targets[i][static_cast<std::size_t>(chosen->values[i])];
      const DesignPlane& plane = PlaneOf(constraints[i]);
      Hold(plane, NearestAcross(plane, target, q_), target.place, true);
      if (constraints[i].is_contact) contacts_.emplace_back(&plane, target);
    }
    return given_up;
  }

  // Whether a combination may be taken that has the component lie there.
  bool MayLieAt(const Eigen::VectorXd& q, const std::vector<OriginalConstraint>& constraints,
                const std::vector<std::vector<Target>>& targets,
                const std::vector<int>& values) const {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] == kNoPlane || !constraints[i].is_contact) continue;
      const Target& target = targets[i][static_cast<std::size_t>(values[i])];
      if (!LiesAcross(PlaneOf(constraints[i]), target, q)) return false;
    }
    return !clearance_.RunsInto(q);
  }

  static std::vector<Demand> DemandsOf(const std::vector<ChoiceOfPlanes>& choices,
                                       const std::vector<int>& values) {
    std::vector<Demand> demands;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] == kNoPlane) continue;
      demands.push_back(
          {choices[i].form, choices[i].values[static_cast<std::size_t>(values[i])], ""});
    }
    return demands;
  }

  // What it costs to stretch all of the component along an axis as far as a level plane is worth.
  // Where its sizes are given, what one part would cost.
  absl::StatusOr<double> StretchCost(Axis axis) {
    std::optional<double>& known = stretch_costs_[static_cast<std::size_t>(axis)];
    if (known) return *known;
    known = options_.stretch * options_.stretch;
    const auto along = [&](const PrincipalPart& part) {
      return part.box.maximum[static_cast<int>(axis)];
    };
    const auto upper = std::max_element(
        parts_.begin(), parts_.end(),
        [&](const PrincipalPart& a, const PrincipalPart& b) { return along(a) < along(b); });
    const auto before = [&](const PrincipalPart& part) {
      return part.box.minimum[static_cast<int>(axis)];
    };
    const auto lower = std::min_element(
        parts_.begin(), parts_.end(),
        [&](const PrincipalPart& a, const PrincipalPart& b) { return before(a) < before(b); });
    const LinearForm extent = FaceOf(*upper, axis, true) - FaceOf(*lower, axis, false);
    for (const double share : {1.0, 0.1}) {
      const double wanted = extent.At(wish_) * (1 + share * options_.stretch);
      MORTISE_ASSIGN_OR_RETURN(const std::optional<MovableSet::Nearest> stretched,
                               set_.NearestTo(wish_, {{extent, wanted, ""}}));
      if (!stretched) continue;
      known = stretched->cost / (share * share);
      break;
    }
    return *known;
  }

  BoundingBox BoxAt(int part, const Eigen::VectorXd& q) const {
    BoundingBox box;
    for (const Axis axis : parametric::kAxes) {
      const int at = static_cast<int>(axis);
      box.minimum[at] = FaceOf(parts_[static_cast<std::size_t>(part)], axis, false).At(q);
      box.maximum[at] = FaceOf(parts_[static_cast<std::size_t>(part)], axis, true).At(q);
    }
    return box;
  }

  // Whether a part of the body whose plane it is lies across from the component's part. What
  // belongs to no part, as a plane in a rest pose of the original, lies nowhere.
  bool LiesAcross(const DesignPlane& plane, const Target& target, const Eigen::VectorXd& q) const {
    if (plane.part < 0) return true;
    const BoundingBox own = BoxAt(plane.part, q);
    return std::any_of(target.planes.begin(), target.planes.end(), [&](const auto* other) {
      return other->part >= 0 &&
             SharedAcross(own, body_parts_[static_cast<std::size_t>(other->part)].box, plane.axis) >
                 tolerance_;
    });
  }

  // Whether what the contacts of the original are met by lies across.
  bool KeepsContacts(const Eigen::VectorXd& q) const {
    return std::all_of(contacts_.begin(), contacts_.end(), [&](const auto& contact) {
      return LiesAcross(*contact.first, contact.second, q);
    });
  }

  // The plane of a target whose part is the nearest.
  const DesignPlane& NearestAcross(const DesignPlane& plane, const Target& target,
                                   const Eigen::VectorXd& q) const {
    if (plane.part < 0) return *target.planes.front();
    const BoundingBox own = BoxAt(plane.part, q);
    const auto apart = [&](const DesignPlane& other) {
      if (other.part < 0) return options_.reach;
      return DistanceBetween(own, body_parts_[static_cast<std::size_t>(other.part)].box);
    };
    return **std::min_element(target.planes.begin(), target.planes.end(),
                              [&](const auto* a, const auto* b) { return apart(*a) < apart(*b); });
  }

  // The nearest design that meets what is held and `more`. Nearest to where the component would be
  // if it were moved as a whole as what is held asks for, so that its parts move against each other
  // only where they must.
  absl::StatusOr<std::optional<Eigen::VectorXd>> Solve(const std::vector<Demand>& more) const {
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    Eigen::Vector3d count = Eigen::Vector3d::Zero();
    std::vector<Demand> demands = held_;
    demands.insert(demands.end(), more.begin(), more.end());
    for (const Demand& demand : demands) {
      Eigen::Vector3d along = Eigen::Vector3d::Zero();
      for (const parametric::LinearTerm& term : demand.form.terms) {
        along += term.coefficient * translations_.row(term.variable).transpose();
      }
      moved += (demand.value - demand.form.At(wish_)) * along;
      count += along;
    }
    moved = moved.cwiseQuotient(count.cwiseMax(1));
    MORTISE_ASSIGN_OR_RETURN(std::optional<MovableSet::Nearest> nearest,
                             set_.NearestTo(wish_ + translations_ * moved, demands));
    if (!nearest) return std::optional<Eigen::VectorXd>();
    return std::optional<Eigen::VectorXd>(std::move(nearest->q));
  }

  void Hold(const DesignPlane& plane, const DesignPlane& target, double place, bool from_original) {
    independent_.Keep(plane.position);
    held_.push_back({plane.position, place, Describe(plane)});
    Alignment made;
    made.component_element = plane.owner;
    made.component_plane = plane.name;
    made.body_element = target.owner;
    made.body_plane = target.name;
    made.axis = plane.axis;
    made.moved_by = place - plane.now;
    made.from_original = from_original;
    const double apart = std::abs(place - target.now);
    made.text = absl::StrCat(
        Describe(plane),
        apart > tolerance_ ? absl::StrCat(" ", 1000 * apart, " mm from ") : " in one plane with ",
        Describe(target), from_original ? ", as in the original design" : "");
    alignments_.push_back(std::move(made));
  }

  // Planes of the component that are free still, with the planes of the body near them.
  struct Near {
    const DesignPlane* plane = nullptr;
    const DesignPlane* target = nullptr;
    double distance = 0;
    double across = 0;  // m, between their parts across the planes
  };

  std::vector<Near> FindNear(const std::set<const DesignPlane*>& given_up) const {
    std::vector<Near> near;
    for (const DesignPlane& plane : planes_) {
      if (given_up.contains(&plane) || !independent_.IsFree(plane.position)) continue;
      const double now = plane.position.At(q_);
      std::optional<Near> nearest;
      for (const DesignPlane& target : body_planes_) {
        if (target.axis != plane.axis) continue;
        const double distance = std::abs(target.now - now);
        if (distance > options_.threshold) continue;
        const Near found{&plane, &target, distance, targets_.Across(plane, target)};
        if (!nearest || IsNearer(found, *nearest)) nearest = found;
      }
      if (nearest) near.push_back(*nearest);
    }
    std::stable_sort(near.begin(), near.end(),
                     [&](const Near& a, const Near& b) { return IsNearer(a, b); });
    return near;
  }

  bool IsNearer(const Near& a, const Near& b) const {
    if (std::abs(a.distance - b.distance) > tolerance_) return a.distance < b.distance;
    return a.across < b.across - tolerance_;
  }

  absl::Status AlignProminent() {
    std::set<const DesignPlane*> given_up;
    double overlap = clearance_.OverlapAt(q_);
    while (true) {
      const std::vector<Near> near = FindNear(given_up);
      if (near.empty()) return absl::OkStatus();
      const Near& first = near.front();
      MORTISE_ASSIGN_OR_RETURN(std::optional<Eigen::VectorXd> aligned,
                               Solve({{first.plane->position, first.target->now, ""}}));
      const double after = !aligned || Deforms(*first.plane, *aligned) || !KeepsContacts(*aligned)
                               ? std::numeric_limits<double>::infinity()
                               : clearance_.OverlapAt(*aligned);
      if (after > overlap + kMaxOverlap) {
        given_up.insert(first.plane);
        continue;
      }
      q_ = std::move(*aligned);
      overlap = after;
      Hold(*first.plane, *first.target, first.target->now, false);
    }
  }

  // Whether an alignment changes sizes although its plane is none of those that bound the
  // component: a drawer may become wider, but its sides do not grow because a board is near them.
  bool Deforms(const DesignPlane& plane, const Eigen::VectorXd& q) const {
    if (plane.side == PlaneSide::kNone || plane.part < 0) return false;
    const int axis = static_cast<int>(plane.axis);
    const double end =
        plane.side == PlaneSide::kMinimum ? bounds_.minimum[axis] : bounds_.maximum[axis];
    if (std::abs(plane.now - end) <= tolerance_) return false;
    for (std::size_t e = 0; e < component_.assembly->elements().size(); ++e) {
      const int size = parametric::SizeVariable(static_cast<int>(e), plane.axis);
      if (std::abs(q[size] - q_[size]) > kDeformed * q_[size]) return true;
    }
    return false;
  }

  // Sizes that would change next to nothing stay as they were, if they can.
  absl::Status KeepSizes() {
    std::vector<Demand> sizes;
    for (const int size : SizesToKeep(*component_.assembly, wish_, q_)) {
      sizes.push_back({LinearForm::Variable(size), wish_[size], ""});
    }
    if (sizes.empty()) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(std::optional<Eigen::VectorXd> kept, Solve(sizes));
    if (kept) q_ = *std::move(kept);
    return absl::OkStatus();
  }

  const Design& component_;
  const Design* original_;
  const Design& body_;
  const SnapOptions& options_;
  const std::vector<PrincipalPart> parts_;
  const std::vector<DesignPlane> planes_;
  const std::vector<PrincipalPart> body_parts_;
  const std::vector<DesignPlane> body_planes_;
  const MovableSet set_;
  IndependentForms independent_;  // of what is held
  const Eigen::MatrixXd translations_;
  const Eigen::VectorXd wish_;
  Eigen::VectorXd q_;  // in space
  const double tolerance_;
  const BoundingBox bounds_;  // of the component's principal parts
  TargetPlanes targets_;
  const Clearance clearance_;
  std::array<std::optional<double>, 3> stretch_costs_;
  std::vector<std::pair<const DesignPlane*, Target>> contacts_;  // that are met
  std::vector<Demand> held_;
  std::vector<Alignment> alignments_;
};

}  // namespace

absl::StatusOr<Snapped> Snap(const Design& component, const Design* original, const Design& body,
                             const SnapOptions& options) {
  return Snapper(component, original, body, options).Snap();
}

}  // namespace mortise::composer
