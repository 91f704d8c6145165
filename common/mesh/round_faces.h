// The round faces of a shape that keep their size where its box is stretched between them: bores,
// pins, rounded edges.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/drawn_shape.h"

namespace mortise::mesh {

// A cylinder along an axis of the shape's box: all faces together that lie in it. Two bores from
// both sides with something solid between them are two.
struct RoundFace {
  int axis = 0;            // 0, 1, 2: the cylinder's is along x, y, z
  Eigen::Vector3d middle;  // m as drawn, from the middle of the box; along the axis, of its extent
  double radius = 0;       // m as drawn
  double length = 0;       // m as drawn, along the axis
  bool is_hollow = false;  // a bore: the solid lies outside
  bool is_whole = false;   // seen along the axis, it goes all the way round
};

// Those of a shape as it was drawn: its triangles' corners lie in its faces. Where a shape is cut
// (DividedAt) they need not. By axis, and then where they lie. O(T log T) for T triangles.
std::vector<RoundFace> RoundFacesOf(const DrawnShape& shape);

}  // namespace mortise::mesh
