#include "services/composer/snapping/snap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
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
#include "services/composer/snapping/original_constraints.h"
#include "services/composer/snapping/plane.h"
#include "services/composer/snapping/posed_planes.h"

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

// How far two boxes are apart across the two other axes, m.
double ApartAcross(const BoundingBox& a, const BoundingBox& b, Axis axis) {
  Eigen::Vector3d gaps = (a.minimum - b.maximum).cwiseMax(b.minimum - a.maximum).cwiseMax(0);
  gaps[static_cast<int>(axis)] = 0;
  return gaps.norm();
}

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
        bounds_(BoundsAround(parts_)) {
    for (const parametric::PlacedPart& part : PartsOf(body)) {
      if (body.assembly->elements()[static_cast<std::size_t>(part.element)].connecting) continue;
      body_solids_.emplace_back(part.name, part.box, body.assembly->ShapeOf(part), part.stretch);
    }
  }

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

  // A plane of the body that one of the component may be aligned with.
  struct Target {
    const DesignPlane* plane = nullptr;
    double place = 0;      // m, where the component's plane then lies
    double distance = 0;   // m, from where it lies now
    bool is_near = false;  // its part is in reach across the plane
  };

  static bool IsOfKind(const DesignPlane& plane, const OutsidePlane& kind) {
    if (kind.side == PlaneSide::kNone) {
      return plane.side == PlaneSide::kNone && plane.name == kind.prominent;
    }
    return plane.part >= 0 && plane.side == kind.side;
  }

  // The planes of one kind; only those that are as broad, if there are any.
  std::vector<Target> TargetsOf(const DesignPlane& plane, const OutsidePlane& kind) const {
    const double furthest = std::max(options_.furthest, plane.extent / 2);
    std::vector<Target> all, as_broad;
    for (const DesignPlane& other : body_planes_) {
      if (other.axis != plane.axis || !IsOfKind(other, kind)) continue;
      const double place = other.now + kind.offset;
      const Target target{&other, place, std::abs(place - plane.now),
                          AcrossOf(plane, other) <= options_.reach};
      if (target.distance > furthest) continue;
      all.push_back(target);
      if (other.is_broad == kind.is_broad) as_broad.push_back(target);
    }
    return as_broad.empty() ? all : as_broad;
  }

  // The K nearest planes that a constraint of the original may be met by, each at another place.
  std::vector<Target> TargetsOf(const OriginalConstraint& constraint, int most) const {
    const DesignPlane& plane = planes_[static_cast<std::size_t>(constraint.plane)];
    std::vector<Target> targets;
    for (const OutsidePlane& kind : constraint.outside) {
      for (const Target& target : TargetsOf(plane, kind)) targets.push_back(target);
    }
    const bool any_near = std::any_of(targets.begin(), targets.end(),
                                      [](const Target& target) { return target.is_near; });
    if (constraint.is_contact && any_near) {
      std::erase_if(targets, [](const Target& target) { return !target.is_near; });
    }
    if (constraint.covers) KeepOrder(plane, targets);
    std::stable_sort(targets.begin(), targets.end(),
                     [](const Target& a, const Target& b) { return a.distance < b.distance; });
    std::vector<Target> nearest;
    for (const Target& target : targets) {
      if (static_cast<int>(nearest.size()) == most) break;
      const bool is_known = std::any_of(nearest.begin(), nearest.end(), [&](const Target& known) {
        return std::abs(known.place - target.place) <= tolerance_;
      });
      if (!is_known) nearest.push_back(target);
    }
    return nearest;
  }

  // Finds what of the body each part of the component would come to lie against: the parts whose
  // faces are the nearest of those that the original's contacts may be met by.
  void FindAgainst(const std::vector<OriginalConstraint>& constraints) {
    for (const OriginalConstraint& one : constraints) {
      const DesignPlane& plane = planes_[static_cast<std::size_t>(one.plane)];
      if (!one.is_contact || plane.part < 0) continue;
      const std::vector<Target> nearest = TargetsOf(one, 1);
      if (nearest.empty()) continue;
      for (const OutsidePlane& kind : one.outside) {
        for (const Target& target : TargetsOf(plane, kind)) {
          const bool is_there = std::abs(target.place - nearest.front().place) <= tolerance_;
          if (!is_there || target.plane->part < 0) continue;
          against_[plane.part].insert(static_cast<std::size_t>(target.plane->part));
        }
      }
    }
  }

  // What lay against the component's part ended at its plane or before it. So it does where nothing
  // that it comes to lie against reaches from one side of the plane to the other, if there are such
  // targets.
  void KeepOrder(const DesignPlane& plane, std::vector<Target>& targets) const {
    const auto against = against_.find(plane.part);
    if (against == against_.end()) return;
    const auto sticks_out = [&](const Target& target) {
      return std::any_of(against->second.begin(), against->second.end(), [&](std::size_t part) {
        return ReachesAcross(body_parts_[part].box, plane.axis, target.place, tolerance_);
      });
    };
    if (std::all_of(targets.begin(), targets.end(), sticks_out)) return;
    std::erase_if(targets, sticks_out);
  }

  absl::Status UseOriginal() {
    std::vector<OriginalConstraint> constraints;
    IndependentForms independent(set_.feasible());
    std::vector<OriginalConstraint> found =
        FindOriginalConstraints(*original_, parts_, planes_, options_.reach);
    FindAgainst(found);
    for (OriginalConstraint& one : found) {
      const LinearForm& form = planes_[static_cast<std::size_t>(one.plane)].position;
      if (!independent.IsFree(form) || TargetsOf(one, 1).empty()) continue;
      independent.Keep(form);
      constraints.push_back(std::move(one));
    }
    while (!constraints.empty()) {
      const auto count = static_cast<double>(constraints.size());
      const int most = std::clamp(static_cast<int>(std::pow(options_.combinations, 1 / count)), 1,
                                  options_.planes);
      MORTISE_ASSIGN_OR_RETURN(const bool met, Choose(constraints, most));
      if (met) return absl::OkStatus();
      constraints.pop_back();
    }
    return absl::OkStatus();
  }

  absl::StatusOr<bool> Choose(const std::vector<OriginalConstraint>& constraints, int most) {
    std::vector<ChoiceOfPlanes> choices;
    std::vector<std::vector<Target>> targets;
    for (const OriginalConstraint& one : constraints) {
      targets.push_back(TargetsOf(one, most));
      ChoiceOfPlanes& choice = choices.emplace_back();
      choice.form = planes_[static_cast<std::size_t>(one.plane)].position;
      for (const Target& target : targets.back()) choice.values.push_back(target.place);
    }
    MORTISE_ASSIGN_OR_RETURN(const std::optional<ChosenPlanes> chosen,
                             ChoosePlanes(set_, wish_, choices));
    if (!chosen) return false;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const DesignPlane& plane = planes_[static_cast<std::size_t>(constraints[i].plane)];
      const auto value = static_cast<std::size_t>(chosen->values[i]);
      Hold(plane, *targets[i][value].plane, targets[i][value].place, true);
    }
    MORTISE_ASSIGN_OR_RETURN(const std::optional<Eigen::VectorXd> met, Solve({}));
    if (met) q_ = *met;
    return met.has_value();
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
        const Near found{&plane, &target, distance, AcrossOf(plane, target)};
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

  double AcrossOf(const DesignPlane& plane, const DesignPlane& target) const {
    if (plane.part < 0 || target.part < 0) return options_.reach;
    return ApartAcross(parts_[static_cast<std::size_t>(plane.part)].box,
                       body_parts_[static_cast<std::size_t>(target.part)].box, plane.axis);
  }

  absl::Status AlignProminent() {
    std::set<const DesignPlane*> given_up;
    double overlap = OverlapAt(q_);
    while (true) {
      const std::vector<Near> near = FindNear(given_up);
      if (near.empty()) return absl::OkStatus();
      const Near& first = near.front();
      MORTISE_ASSIGN_OR_RETURN(std::optional<Eigen::VectorXd> aligned,
                               Solve({{first.plane->position, first.target->now, ""}}));
      const double after = !aligned || Deforms(*first.plane, *aligned)
                               ? std::numeric_limits<double>::infinity()
                               : OverlapAt(*aligned);
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

  // How deep the component reaches into the body at these parameters, m: the sum over all parts.
  double OverlapAt(const Eigen::VectorXd& q) const {
    const Design there = FromSpace(component_.assembly, q);
    double sum = 0;
    for (const parametric::PlacedPart& part : PartsOf(there)) {
      if (component_.assembly->elements()[static_cast<std::size_t>(part.element)].connecting) {
        continue;
      }
      const SolidPart solid(part.name, part.box, component_.assembly->ShapeOf(part), part.stretch);
      for (const SolidPart& other : body_solids_) sum += SolidPart::DepthOf(solid, other);
    }
    return sum;
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
  std::vector<SolidPart> body_solids_;
  // By part of the component, those of the body.
  std::map<int, std::set<std::size_t>> against_;
  std::vector<Demand> held_;
  std::vector<Alignment> alignments_;
};

}  // namespace

absl::StatusOr<Snapped> Snap(const Design& component, const Design* original, const Design& body,
                             const SnapOptions& options) {
  return Snapper(component, original, body, options).Snap();
}

}  // namespace mortise::composer
