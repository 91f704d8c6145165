// Finds which triangles of a closed surface lie beside each other, and how sharply they meet. It is
// faster than a half-edge mesh (halfedge_mesh.h) where no walks are needed.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/functional/function_ref.h"

namespace mortise::mesh {

// An edge with the triangles either side of it.
struct SharedEdge {
  int low = -1;  // vertices
  int high = -1;
  int first = -1;  // triangles
  int second = -1;
};

// Returns all edges of a closed surface, by `low`, then `high`. O(T log T) for T triangles.
std::vector<SharedEdge> SharedEdges(const Eigen::Matrix3Xi& triangles);

// An angle that is more than between triangles side by side in one curved face that the CAD kernel
// drew, rad.
inline constexpr double kSharpTurn = 0.7;

// Returns the groups of triangles that hang together over edges that join them, each group in
// order, by their first triangle. O(T log T).
std::vector<std::vector<int>> ConnectedTriangles(Eigen::Index triangles,
                                                 const std::vector<SharedEdge>& edges,
                                                 absl::FunctionRef<bool(const SharedEdge&)> joins);

// Returns the outward normals of length 1, 3 × T; zero where a triangle has no area.
Eigen::Matrix3Xd TriangleNormals(const Eigen::Matrix3Xd& vertices,
                                 const Eigen::Matrix3Xi& triangles);

// Returns the angle between the outward normals of two triangles, rad: 0 in one plane.
double TurnBetween(const Eigen::Vector3d& first, const Eigen::Vector3d& second);

}  // namespace mortise::mesh
