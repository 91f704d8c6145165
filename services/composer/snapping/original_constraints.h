// Finds what the original design says of where a component goes: the coplanarities between it and
// what it was connected to (thesis §5.5).
#pragma once

#include <vector>

#include "services/composer/snapping/plane.h"

namespace mortise::composer {

// A kind of plane outside of the component that one of its planes was in line with.
struct OutsidePlane {
  PlaneSide side = PlaneSide::kNone;  // of a face; kNone of a prominent plane
  std::string prominent;              // its name
  bool is_broad = false;              // a face of those that are broad (IsBroadAcross)
  // m, of the component's plane from it: 0 in one plane. Where what connects the two, as the slides
  // of a drawer do, holds them at a distance in all designs, that distance.
  double offset = 0;
};
inline bool operator==(const OutsidePlane& a, const OutsidePlane& b) {
  return a.side == b.side && a.prominent == b.prominent && a.is_broad == b.is_broad &&
         a.offset == b.offset;
}

// A plane of the component, and what it was in line with in the original.
struct OriginalConstraint {
  int plane = 0;                      // index into the component's planes
  std::vector<OutsidePlane> outside;  // any of these kinds will do
  // Faces lay against each other, on two sides, or were held at a distance; else they were level.
  bool is_contact = false;
  double area = 0;  // m², over which they faced each other
  // Nothing that the component's part lay against reached from one side of the plane to the other:
  // a top that ended level with its legs covered them. The order of planes is kept as their level
  // is.
  bool covers = false;
};

// Returns the constraints, those of faces that lay against each other first, the larger first; then
// the others in the order of the component's planes. A plane has one at most, of contacts if there
// are any. Looked at are
// - principal parts of `original`, as drawn, whose elements touch or share a connection with an
//   element that the component has some of, and whose boxes are no further from the component's
//   part than `reach`, m. What a joint moves away from the component is left out.
// - prominent planes of all principal parts: they are drawn to be aligned with.
// - of planes in the rest poses of joints of the original (PlanesInPosesOf): principal parts, not
//   moved by the pose, within `reach` of the part there. A door that is drawn open meets the
//   opposite side when it is shut.
//
// The component's parts are known in the original by their names. O(parts · parts).
std::vector<OriginalConstraint> FindOriginalConstraints(
    const Design& original, const std::vector<PrincipalPart>& component_parts,
    const std::vector<DesignPlane>& component_planes, double reach);

}  // namespace mortise::composer
