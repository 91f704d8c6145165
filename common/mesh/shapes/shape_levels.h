// Finds the levels at which the surface of a shape turns back along the axes of its box:
// - flat faces at right angles to an axis,
// - places where a curved face, or a countersink in a flat one, reaches furthest, as a bore does on
//   either side of its axis, and
// - the depths of countersinks.
//
// Whatever fits into a shape meets it there. As the box is stretched in proportion these places
// keep their fractions of it; where a level divides the shape, both sides can be stretched by
// themselves.
#pragma once

#include <vector>

#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::mesh {

inline constexpr std::size_t kMaxLevels = 64;  // along an axis

struct ShapeLevel {
  int axis = 0;         // 0, 1, 2: x, y, z
  double fraction = 0;  // of the box's size along the axis, from its middle; between -1/2 and 1/2
  // True if every face that reaches from one side of the level to the other, by more than kOnPlane,
  // runs along the axis there or is of a cylinder that does: stretching one side more than the
  // other bends none. In a shape drawn as one face, as uploaded meshes are, pieces that hang
  // together smoothly count as faces.
  bool divides = false;
};

// Returns all levels within the box, its faces left out, by axis and then fraction. Levels of round
// faces (round_faces.h) are where these reach furthest, whatever their triangles miss; other curved
// faces are known by their triangles, which may be trusted as far as DeflectionIn says. Where there
// are more than kMaxLevels along an axis, those of the largest flat faces remain. O(T log T) for T
// triangles.
std::vector<ShapeLevel> LevelsOf(const DrawnShape& shape);

// Returns the shape with its triangles cut along these levels, so that none reaches across one.
// Vertices within kOnPlane of a level count as on it. The old vertices stay, in their order; new
// ones come after them, exactly at their level. Names, planes, the B-rep and the volume stay; each
// new triangle is of the face of the one it was cut from. A closed surface stays closed. What the
// new triangles miss is measured (missed_volume.h). O(T (L + log T)) for T triangles that come of
// it and L levels.
DrawnShape DividedAt(const DrawnShape& shape, const std::vector<ShapeLevel>& levels);

}  // namespace mortise::mesh
