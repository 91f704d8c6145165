// Estimates the volume that the triangles of a shape with curved faces miss, or have too much at
// hollow ones. The estimate is our own.
#pragma once

#include <Eigen/Core>

#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::mesh {

// Returns the volume that the exact solid has beyond each triangle, T, m³ as drawn, negative at
// hollow faces. The sum is the volume of the solid less that of its triangles.
//
// How the sum spreads over triangles is estimated: two flat pieces of one face that meet at an
// angle are taken to miss what a circular arc stands out from its chord. For cylinders that are
// evenly divided this is exact. The rest of the sum is shared out in proportion to the estimate, so
// that each face is as far off as faces are estimated unequally well: for balls, by less than a
// tenth of what its triangles miss. Cutting triangles cuts what they miss. O(T log T) for T
// triangles.
Eigen::VectorXd MissedVolumes(const DrawnShape& shape);

// Returns all that the triangles miss in a stretch at whose levels the shape is divided, m³. O(T
// log L) for L levels, if the shape knows what its triangles miss (DividedAt).
double MissedVolumeIn(const DrawnShape& shape, const BoxStretch& stretch);

}  // namespace mortise::mesh
