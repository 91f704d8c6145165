// Points on the triangles of a surface that is still to move.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

// Returns the box around points (3 × n, n >= 1).
inline Eigen::AlignedBox3d BoxAround(const Eigen::Matrix3Xd& points) {
  return {points.rowwise().minCoeff(), points.rowwise().maxCoeff()};
}

// Returns the area of a triangle as a vector along its normal.
inline Eigen::Vector3d AreaVector(const Eigen::Matrix3Xd& vertices,
                                  const Eigen::Vector3i& corners) {
  const Eigen::Vector3d a = vertices.col(corners[0]);
  return 0.5 * (vertices.col(corners[1]) - a).cross(vertices.col(corners[2]) - a);
}

// Points by triangle and barycentric coordinates: linear functions of the vertices.
struct MeshPoints {
  Eigen::VectorXi triangles;     // n
  Eigen::Matrix3Xd barycentric;  // 3 × n

  Eigen::Index size() const { return triangles.size(); }

  Eigen::Matrix3Xd PlacesOn(const mesh::SurfaceMesh& surface) const;   // 3 × n
  Eigen::Matrix3Xd NormalsOn(const mesh::SurfaceMesh& surface) const;  // 3 × n, of length 1 or 0
};

// First `count` points spread evenly by area, then one in the middle of each triangle that has none
// of these, so that narrow faces have some; not of those that are nothing beside the whole. The
// same surface gives the same points. The surface has an area.
MeshPoints SampleSurface(const mesh::SurfaceMesh& surface, Eigen::Index count);

// Returns the barycentric coordinates, of sum 1, of the point of the triangle's plane (corners in
// columns) that is nearest to `place`; a little outside of the triangle at most.
Eigen::Vector3d BarycentricOf(const Eigen::Matrix3d& corners, const Eigen::Vector3d& place);

}  // namespace mortise::retrieval
