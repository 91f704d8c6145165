// Finds the flat faces of a closed surface: groups of its triangles, and the loops round each.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Connected triangles of one face that lie in one plane.
struct FlatFace {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // m, of the plane
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  int face = -1;  // of the surface, that its triangles belong to
  // The vertices of every loop round it, its own triangles on the left.
  std::vector<std::vector<int>> loops;
};

// Divides a closed surface into flat faces. Neighbours are of one flat face if they are of the same
// face of the surface (`triangle_face`, of each triangle) and the vertices of both lie within
// `in_plane`, m, of the plane of the largest of its triangles. O(T log T).
//
// INVALID_ARGUMENT, "shape", with the place, for an edge that is no longer than `in_plane`, that is
// open, or that two triangles run along in the same direction.
absl::StatusOr<std::vector<FlatFace>> FindFlatFaces(const SurfaceMesh& surface,
                                                    const Eigen::VectorXi& triangle_face,
                                                    double in_plane);

}  // namespace mortise::mesh
