// Where the surface of a shape turns back along the axes of its box: at flat faces at right angles
// to one, and where a curved face reaches furthest, as a bore does on either side of its axis. What
// fits into a shape meets it there, and as the box is stretched these places keep their fractions
// of it.
#pragma once

#include <vector>

#include "common/mesh/drawn_shape.h"

namespace mortise::mesh {

inline constexpr std::size_t kMostLevels = 64;  // along an axis

struct ShapeLevel {
  int axis = 0;         // 0, 1, 2: x, y, z
  double fraction = 0;  // of the box's size along the axis, from its middle; between -1/2 and 1/2
};

// All levels within the box, its faces left out, by axis and then fraction. Curved faces are known
// by their triangles, which DeflectionIn says how far to trust. Past kMostLevels along an axis,
// those of the largest flat faces. O(T log T) for T triangles.
std::vector<ShapeLevel> LevelsOf(const DrawnShape& shape);

}  // namespace mortise::mesh
