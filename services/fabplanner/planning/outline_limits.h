// Finds the inner arcs and corners of an outline that the jigsaw cannot follow. Private to this
// folder.
//
// The saw goes around the part, in the waste. It follows every outer corner, coming and going
// straight, but turns inwards by its least radius at most. Arcs are polygons here: behind an inner
// corner of the polygon may be the bend of an arc. Between inner corners that turn by a and b, at
// the ends of an edge of length l, an arc of radius l / (tan(a/2) + tan(b/2)) touches the edge and
// both its neighbours; where that is less than the saw's radius, the saw passes both corners in one
// bend of a + b. Of a bend that turns by a about an arc of radius r the saw of radius R leaves
// (R − r) (1 / cos(a/2) − 1) in the corner.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// What the saw may leave in an inner corner, m: less than it and the sandpaper behind it miss.
inline constexpr double kCornerTolerance = 5e-4;

// Returns at most two limits of an outline (counter-clockwise, m): of its inner corners, whose
// radius is 0, and of its inner arcs, with the least of their radii. `radius` is the saw's, m.
std::vector<MachineLimit> OutlineLimits(const std::vector<Eigen::Vector2d>& outline, double radius);

}  // namespace mortise::fabplanner
