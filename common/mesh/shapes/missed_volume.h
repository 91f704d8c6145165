// The volume that the triangles of a shape with curved faces miss, or have too much at hollow ones.
#pragma once

#include <Eigen/Core>

#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::mesh {

// T, m³ as drawn: of each triangle what the exact solid has beyond it, negative at hollow faces.
// The sum is the volume of the solid less that of its triangles.
//
// Where the sum belongs is estimated: two flat pieces of one face that meet at an angle are taken
// to miss what a circular arc stands out from its chord. Of cylinders that are evenly divided this
// is exact. What is then left is shared out by it, so that each face is as far off as faces are
// estimated unequally well: for balls, by less than a tenth of what its triangles miss. Cutting
// triangles cuts what they miss. O(T log T) for T triangles.
Eigen::VectorXd MissedVolumes(const DrawnShape& shape);

// m³: all of it, in a stretch at whose levels the shape is divided. O(T log L) for L levels, if the
// shape knows what its triangles miss (DividedAt).
double MissedVolumeIn(const DrawnShape& shape, const BoxStretch& stretch);

}  // namespace mortise::mesh
