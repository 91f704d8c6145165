// How firmly solids stand on a level floor; z points upwards.
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Of the support polygon, which is the convex hull of all that touches the floor.
struct Standing {
  // m, on the floor from below the centre of mass to the polygon's nearest edge; negative outside:
  // it topples. Never positive for what stands on a line or a point.
  double margin = 0;
  // rad, by which the floor may tilt about that edge before the centre of mass is above it: the
  // angle whose tangent is the margin over the height of the centre of mass.
  double angle = 0;
};

// The floor is at the solids' lowest point; what is above it by at most 1e-5 of their box's
// diagonal touches it. Zero without vertices. O(V log V).
Standing StandOnFloor(std::span<const SurfaceMesh> solids, const Eigen::Vector3d& center_of_mass);

}  // namespace mortise::mesh
