// Private to this folder. Finds the planes of the body of a model that a constraint of the original
// design may be met by (thesis §5.5).
#pragma once

#include <map>
#include <set>
#include <vector>

#include "services/composer/snapping/original_constraints.h"
#include "services/composer/snapping/plane.h"
#include "services/composer/snapping/snap.h"

namespace mortise::composer {

// Planes of the body at one place that a plane of the component may be aligned with.
struct Target {
  std::vector<const DesignPlane*> planes;
  double place = 0;     // m, where the component's plane then lies
  double distance = 0;  // m, from where it lies now
};

// Returns how far two boxes are apart across the two other axes, m.
double ApartAcross(const parametric::BoundingBox& a, const parametric::BoundingBox& b, Axis axis);

// Returns how much two boxes share along that of the two other axes along which they share less, m;
// less than 0 where they are apart.
double SharedAcross(const parametric::BoundingBox& a, const parametric::BoundingBox& b, Axis axis);

// A component and the body as they are now. What it is given must outlive it.
class TargetPlanes {
 public:
  struct Side {
    const std::vector<PrincipalPart>& parts;
    const std::vector<DesignPlane>& planes;
  };

  // Planes at the same place within `tolerance`, m, are one target.
  TargetPlanes(const Side& component, const Side& body, const SnapOptions& options,
               double tolerance)
      : component_(component), body_(body), options_(options), tolerance_(tolerance) {}

  // Finds what of the body each part of the component would come to lie against: the parts whose
  // faces are the nearest of those that the contacts may be met by. By that those that cover what
  // they lie against are met.
  void FindAgainst(const std::vector<OriginalConstraint>& constraints);

  // Returns the nearest targets of a constraint, `most` of them at most, the nearest first.
  std::vector<Target> Of(const OriginalConstraint& constraint, int most) const;

  // Returns how far a plane of the component is apart from one of the body across them, m.
  double Across(const DesignPlane& plane, const DesignPlane& target) const;

 private:
  // One plane that may be a target.
  struct Candidate {
    const DesignPlane* plane = nullptr;
    double place = 0, distance = 0;
    bool is_near = false;  // its part is in reach across the plane
  };

  static bool IsOfKind(const DesignPlane& plane, const OutsidePlane& kind);
  std::vector<Candidate> CandidatesOf(const DesignPlane& plane, const OutsidePlane& kind) const;
  void KeepOrder(const DesignPlane& plane, std::vector<Candidate>& candidates) const;

  const Side component_;
  const Side body_;
  const SnapOptions& options_;
  const double tolerance_;
  // By part of the component, those of the body.
  std::map<int, std::set<std::size_t>> against_;
};

}  // namespace mortise::composer
