// Finds where bores widen towards a flat face: countersinks, and rims that are chamfered or
// rounded.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::mesh {

struct Countersink {
  int axis = 0;                                      // of the bore: 0, 1, 2
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // m as drawn, from the middle of the box;
                                                     // along the axis, of its depth
  double radius = 0;                                 // m as drawn, of the circle in the flat face
  double depth = 0;                                  // m as drawn
};

// Returns the countersinks of a shape as it was drawn whose flat face is at right angles to an axis
// of its box, and has the circle to itself all the way round. They are in the order of their axis,
// then of where they lie. O(T log T) for T triangles.
std::vector<Countersink> CountersinksOf(const DrawnShape& shape);

}  // namespace mortise::mesh
