// Finds a point inside a closed surface.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Returns a point strictly inside a closed, outward surface without self-intersections: halfway
// through the thickest stretch found under the middles of its largest triangles. O(triangles) for
// each of a few of them. INVALID_ARGUMENT, "surface", if there is nothing inside.
absl::StatusOr<Eigen::Vector3d> InsidePoint(const SurfaceMesh& surface);

}  // namespace mortise::mesh
