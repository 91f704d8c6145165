// Carries pressures on the faces of cells over to the surface that the cells were made around.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::simulator {

// The faces of cells along a wall.
struct WallFaces {
  Eigen::Matrix3Xd centers;  // m
  Eigen::Matrix3Xd areas;    // m², times the unit vector out of the body
  Eigen::VectorXd values;
};

// Reads polygons and the values on them from an old-style VTK file as text. INTERNAL where that is
// not what it is.
absl::StatusOr<WallFaces> ReadWallFaces(std::string_view vtk);

// Returns the triangles of a surface, halved across their longest edge until none is longer than
// `length`; each has vertices of its own.
mesh::SurfaceMesh DividedTriangles(const mesh::SurfaceMesh& surface, double length);

// Returns the value at each vertex of a surface whose triangles share none: of the four nearest
// faces that look the same way as the triangle, weighted by one over the distance squared, so that
// both sides of a thin plate keep their own. O(log n) each for n faces.
Eigen::VectorXd ValuesAtVertices(const WallFaces& faces, const mesh::SurfaceMesh& surface);

// Returns a value for each column of `nodes`, 3 × N, m: what ValuesAtVertices has there on each of
// the triangles that meet in it, weighted by their areas; 0 for nodes of none. `triangles` are 3 ×
// T nodes, or 6 × T: corners, then the middles of 01, 12, 20; they look out of the body.
Eigen::VectorXd ValuesAtNodes(const WallFaces& faces, const Eigen::Matrix3Xd& nodes,
                              const Eigen::MatrixXi& triangles);

}  // namespace mortise::simulator
