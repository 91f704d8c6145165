// What hangs together in a surface: triangles that share corners, by index or by place.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/scenes/scene.h"

namespace mortise::mesh {

// For each of the N points (3 × N) the number of its place, counted from 0 in the order in which
// the places are first met.
//
// With tolerance 0, points of equal coordinates (0 and -0 are equal) are one place. With a positive
// tolerance, in the points' unit, all points nearer to each other than it are one place, and so are
// those that a chain of such points joins; of points up to 3.5 tolerances apart some are joined,
// too, as points are compared by cells of a grid that begins at the least coordinates. O(N) in
// either case, whatever the points. Coordinates must be finite.
Eigen::VectorXi WeldPoints(const Eigen::Matrix3Xd& points, double tolerance = 0);

// Which piece each triangle belongs to. Pieces are counted from 0 in the order of their first
// triangles.
struct ConnectedTriangles {
  Eigen::VectorXi piece;  // T
  int count = 0;
};

// Returns the connected pieces of a surface. Two triangles that have a corner in common are in one
// piece: the same vertex, or vertices at one place (WeldPoints), so that a soup in which every
// triangle has vertices of its own hangs together where it touches. `relative_tolerance` is a
// fraction of the diagonal of the box around the vertices; at least 1e-12 if it is not 0. Indices
// must be of vertices, coordinates finite.
ConnectedTriangles FindConnected(const Eigen::Matrix3Xd& vertices,
                                 const Eigen::Matrix3Xi& triangles, double relative_tolerance = 0);

// Returns what some triangles of a component are by themselves, without a name: these, by their
// numbers, and the vertices that they use, both in their order. It takes no longer for what else
// there is.
SceneComponent PieceOf(const SceneComponent& component, const std::vector<int>& triangles);

// Returns the connected pieces of a component, each with the vertices that it uses, in their order.
// A component of one piece keeps its name, those of several are numbered: "leg 1", "leg 2", or "1",
// "2" without a name.
std::vector<SceneComponent> Separated(const SceneComponent& component,
                                      double relative_tolerance = 0);

}  // namespace mortise::mesh
