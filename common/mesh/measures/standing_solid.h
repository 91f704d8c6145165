// Measures how firmly solids stand on a level floor; z points upwards.
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// How firm the support polygon makes solids stand, which is the convex hull of all that touches the
// floor.
struct Standing {
  // The distance on the floor from below the centre of mass to the polygon's nearest edge, m;
  // negative outside, where the solids topple. It is never positive for what stands on a line or a
  // point.
  double margin = 0;
  // The angle by which the floor may tilt about that edge before the centre of mass is above it,
  // rad. Its tangent is the margin over the height of the centre of mass.
  double angle = 0;
};

// Measures how solids stand. The floor is at their lowest point; what is above it by at most 1e-5
// of their box's diagonal touches it. The result is zero without vertices. O(V log V).
Standing StandOnFloor(std::span<const SurfaceMesh> solids, const Eigen::Vector3d& center_of_mass);

}  // namespace mortise::mesh
