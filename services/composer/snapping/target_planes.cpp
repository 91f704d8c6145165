#include "services/composer/snapping/target_planes.h"

#include <algorithm>
#include <cmath>

namespace mortise::composer {

using parametric::BoundingBox;

double ApartAcross(const BoundingBox& a, const BoundingBox& b, Axis axis) {
  Eigen::Vector3d gaps = (a.minimum - b.maximum).cwiseMax(b.minimum - a.maximum).cwiseMax(0);
  gaps[static_cast<int>(axis)] = 0;
  return gaps.norm();
}

double SharedAcross(const BoundingBox& a, const BoundingBox& b, Axis axis) {
  const Eigen::Vector3d shared = a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum);
  const int at = static_cast<int>(axis);
  return std::min(shared[(at + 1) % 3], shared[(at + 2) % 3]);
}

bool TargetPlanes::IsOfKind(const DesignPlane& plane, const OutsidePlane& kind) {
  if (kind.side == PlaneSide::kNone) {
    return plane.side == PlaneSide::kNone && plane.name == kind.prominent;
  }
  return plane.part >= 0 && plane.side == kind.side;
}

double TargetPlanes::Across(const DesignPlane& plane, const DesignPlane& target) const {
  if (plane.part < 0 || target.part < 0) return options_.reach;
  return ApartAcross(component_.parts[static_cast<std::size_t>(plane.part)].box,
                     body_.parts[static_cast<std::size_t>(target.part)].box, plane.axis);
}

// The planes of one kind; only those that are as broad, if there are any.
std::vector<TargetPlanes::Candidate> TargetPlanes::CandidatesOf(const DesignPlane& plane,
                                                                const OutsidePlane& kind) const {
  const double furthest = std::max(options_.furthest, plane.extent / 2);
  std::vector<Candidate> all, as_broad;
  for (const DesignPlane& other : body_.planes) {
    if (other.axis != plane.axis || !IsOfKind(other, kind)) continue;
    const double place = other.now + kind.offset;
    const Candidate candidate{&other, place, std::abs(place - plane.now),
                              Across(plane, other) <= options_.reach};
    if (candidate.distance > furthest) continue;
    all.push_back(candidate);
    if (other.is_broad == kind.is_broad) as_broad.push_back(candidate);
  }
  return as_broad.empty() ? all : as_broad;
}

std::vector<Target> TargetPlanes::Of(const OriginalConstraint& constraint, int most) const {
  const DesignPlane& plane = component_.planes[static_cast<std::size_t>(constraint.plane)];
  std::vector<Candidate> candidates;
  for (const OutsidePlane& kind : constraint.outside) {
    for (const Candidate& one : CandidatesOf(plane, kind)) candidates.push_back(one);
  }
  const bool any_near = std::any_of(candidates.begin(), candidates.end(),
                                    [](const Candidate& one) { return one.is_near; });
  if (constraint.is_contact && any_near) {
    std::erase_if(candidates, [](const Candidate& one) { return !one.is_near; });
  }
  if (constraint.covers) KeepOrder(plane, candidates);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  std::vector<Target> nearest;
  for (const Candidate& one : candidates) {
    const auto known = std::find_if(nearest.begin(), nearest.end(), [&](const Target& target) {
      return std::abs(target.place - one.place) <= tolerance_;
    });
    if (known != nearest.end()) {
      known->planes.push_back(one.plane);
    } else if (static_cast<int>(nearest.size()) < most) {
      nearest.push_back({{one.plane}, one.place, one.distance});
    }
  }
  return nearest;
}

void TargetPlanes::FindAgainst(const std::vector<OriginalConstraint>& constraints) {
  for (const OriginalConstraint& one : constraints) {
    const DesignPlane& plane = component_.planes[static_cast<std::size_t>(one.plane)];
    if (!one.is_contact || plane.part < 0) continue;
    for (const Target& target : Of(one, 1)) {
      for (const DesignPlane* const other : target.planes) {
        if (other->part >= 0) against_[plane.part].insert(static_cast<std::size_t>(other->part));
      }
    }
  }
}

// What lay against the component's part ended at its plane or before it. So it does where nothing
// that it comes to lie against reaches from one side of the plane to the other, if there are such
// planes.
void TargetPlanes::KeepOrder(const DesignPlane& plane, std::vector<Candidate>& candidates) const {
  const auto against = against_.find(plane.part);
  if (against == against_.end()) return;
  const auto sticks_out = [&](const Candidate& candidate) {
    return std::any_of(against->second.begin(), against->second.end(), [&](std::size_t part) {
      return ReachesAcross(body_.parts[part].box, plane.axis, candidate.place, tolerance_);
    });
  };
  if (std::all_of(candidates.begin(), candidates.end(), sticks_out)) return;
  std::erase_if(candidates, sticks_out);
}

}  // namespace mortise::composer
