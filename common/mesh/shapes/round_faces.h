// Finds the round faces of a shape that keep their size where its box is stretched between them:
// bores, pins, rounded edges.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::mesh {

// A cylinder along an axis of the shape's box: all faces together that lie in it. Two bores from
// both sides with something solid, or a gap, between them are two.
struct RoundFace {
  int axis = 0;                                      // 0, 1, 2: the cylinder's is along x, y, z
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // m as drawn, from the middle of the box;
                                                     // along the axis, of its extent
  double radius = 0;                                 // m as drawn
  double length = 0;                                 // m as drawn, along the axis
  bool is_hollow = false;                            // a bore: the solid lies outside
  bool is_whole = false;  // seen along the axis, it goes all the way round

  // Whether the face has the place where the cylinder reaches furthest, at middle ± radius, by axis
  // and end, lower then upper. A quarter of a cylinder has two such places, or one.
  std::array<std::array<bool, 2>, 3> reaches = {};
  double widest_arc = 0;  // rad, of a triangle seen along the axis
  std::vector<int> triangles;
};

// Returns the round faces of a shape as it was drawn, the corners of whose triangles lie in its
// faces; where a shape is cut (DividedAt) they need not. They are in the order of their axis, and
// then of where they lie. A face of the shape that has several round pieces, as that of an uploaded
// mesh has, counts by piece. What is only a surface has none. A piece that is drawn with fewer than
// three chords, or with more than 40° between them, is taken for flat. O(T log T) for T triangles.
std::vector<RoundFace> RoundFacesOf(const DrawnShape& shape);

}  // namespace mortise::mesh
