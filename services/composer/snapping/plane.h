// The planes of designs by which components are aligned (thesis §5.5): the faces of principal
// parts, and prominent planes, in every rest pose.
#pragma once

#include <string>
#include <vector>

#include "common/assembly/polyhedra/linear_form.h"
#include "services/composer/model/design.h"
#include "services/composer/model/placed_forms.h"

namespace mortise::composer {

enum class PlaneSide { kMinimum, kMaximum, kNone };  // kNone: a prominent plane has no side

struct DesignPlane {
  int part = -1;      // index into PrincipalPartsOf the design; -1 in a rest pose
  std::string owner;  // the part's or element's name
  std::string name;   // "x minimum", or a prominent plane's name, with the pose it is in
  Axis axis = Axis::kX;
  PlaneSide side = PlaneSide::kNone;
  bool is_broad = false;            // one of the broad faces of its part (IsBroadAcross)
  parametric::LinearForm position;  // m, of the design's parameters in space
  double now = 0;                   // m, its value
};

// Returns the planes of all principal parts as they are now, part by part: six faces each. Then
// come the prominent planes of principal elements, and in each rest pose the planes of what it
// moves. O(parts + poses · elements).
std::vector<DesignPlane> PlanesOf(const Design& design, const std::vector<PrincipalPart>& parts);

// "'shelf 3' x minimum".
std::string Describe(const DesignPlane& plane);

}  // namespace mortise::composer
