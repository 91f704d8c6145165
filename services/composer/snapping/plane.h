// The planes of designs by which components are aligned (thesis §5.5): the faces of principal
// parts, and prominent planes, in every rest pose.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/assembly/polyhedra/linear_form.h"
#include "services/composer/model/design.h"
#include "services/composer/model/placed_forms.h"

namespace mortise::composer {

enum class PlaneSide { kMinimum, kMaximum, kNone };  // kNone: a prominent plane has no side

// Where a plane is in a rest pose of the original design, as that is drawn.
struct PlaneInOriginal {
  int moved_group = 0;          // what the pose moves: the component, and perhaps more
  parametric::BoundingBox box;  // m, of its element in the pose
  double place = 0;             // m, of the plane
};

struct DesignPlane {
  int part = -1;      // index into PrincipalPartsOf the design; -1 in a rest pose
  std::string owner;  // the part's or element's name
  std::string name;   // "x minimum", or a prominent plane's name, with the pose it is in
  Axis axis = Axis::kX;
  PlaneSide side = PlaneSide::kNone;
  bool is_broad = false;            // one of the broad faces of its part (IsBroadAcross)
  parametric::LinearForm position;  // m, of the design's parameters in space
  double now = 0;                   // m, its value
  double extent = 0;                // m, how large its element or part is along the axis
  // Of a plane in a pose of a joint that the component comes without (PlanesInPosesOf).
  std::optional<PlaneInOriginal> in_original = std::nullopt;
};

// Returns the planes of all principal parts as they are now, part by part: six faces each. Then
// come the prominent planes of principal elements, and in each rest pose the planes of what it
// moves. O(parts + poses · elements).
std::vector<DesignPlane> PlanesOf(const Design& design, const std::vector<PrincipalPart>& parts);

// "'shelf 3' x minimum".
std::string Describe(const DesignPlane& plane);

}  // namespace mortise::composer
