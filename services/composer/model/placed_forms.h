// Says where each part of a design lies as functions of its parameters, parts of rows too.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/assembly/polyhedra/linear_form.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// A principal part as it is now.
struct PrincipalPart {
  std::string name;      // as PlacedPart says
  std::string drawn_as;  // the part of the design's assembly that it is, or is a copy of
  std::string item;
  int element = 0;
  parametric::BoundingBox box;  // m, the design's shift included
  // The box as functions of the design's parameters in space (InSpace), by axis. They hold as long
  // as rows have as many parts as they have now.
  std::array<parametric::LinearForm, 3> center, size;
  std::array<bool, 3> is_fixed = {false, false, false};  // its item leaves the size no choice
};

// Returns how far two boxes are apart, m: the distance between their nearest corners, edges or
// faces; 0 if they meet.
double DistanceBetween(const parametric::BoundingBox& a, const parametric::BoundingBox& b);

// Returns how different two boxes are: the distance of their corners, m.
double CornerDistance(const parametric::BoundingBox& a, const parametric::BoundingBox& b);

// Whether a box reaches by more than `tolerance`, m, to either side of a place on an axis.
bool ReachesAcross(const parametric::BoundingBox& box, Axis axis, double place, double tolerance);

// Whether the faces across an axis are the broad ones of a part with this box, as a board's two:
// along no other axis is it much thinner. A square post has four.
bool IsBroadAcross(const parametric::BoundingBox& box, Axis axis);

// Returns all principal parts of a design. O(parts).
std::vector<PrincipalPart> PrincipalPartsOf(const Design& design);

// Returns the face of a part's box at the lower or upper end of an axis, as a function of the
// parameters.
parametric::LinearForm FaceOf(const PrincipalPart& part, Axis axis, bool upper);

}  // namespace mortise::composer
