// Measures how firmly solids stand on a level floor; z points upwards.
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// What solids stand on.
struct Support {
  double floor = 0;  // m, where their lowest point is
  Eigen::Matrix2Xd
      corners;  // m, of the support polygon, against the clock; 1 or 2 where there is none
};

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
  // The way it falls over that edge, a unit vector on the floor; zero for what stands on a point.
  Eigen::Vector2d falls_towards = Eigen::Vector2d::Zero();
};

// Returns what solids stand on. The floor is at their lowest point; what is above it by at most
// 1e-5 of their box's diagonal touches it. There are no corners without vertices. O(V log V).
Support SupportOf(std::span<const SurfaceMesh> solids);

// Measures how what has its mass there stands. The result is zero without corners. O(corners).
Standing StandOn(const Support& support, const Eigen::Vector3d& center_of_mass);

// Measures how solids stand: StandOn of SupportOf.
Standing StandOnFloor(std::span<const SurfaceMesh> solids, const Eigen::Vector3d& center_of_mass);

// Returns the least force, N, downwards at a point of the floor's plane, m, that tips over what
// weighs `weight`, N: about any edge of the polygon that the point is outside of, the moments of
// both are then equal. It is 0 for what topples by itself, and infinite inside the polygon.
double TippingForce(const Support& support, const Eigen::Vector3d& center_of_mass, double weight,
                    const Eigen::Vector2d& point);

}  // namespace mortise::mesh
