// Places of points in triangles in space. Private to this folder.
#pragma once

#include <Eigen/Core>

namespace mortise::interpolator {

// Returns the barycentric coordinates of a point in a triangle: of its projection into the plane,
// those that are negative taken to be 0, of sum 1. A triangle without area has its longest side
// counted.
Eigen::Vector3d BarycentricIn(const Eigen::Matrix3d& corners, const Eigen::Vector3d& point);

}  // namespace mortise::interpolator
