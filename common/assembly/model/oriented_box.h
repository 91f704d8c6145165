// Boxes anywhere in space, and what separates two of them.
#pragma once

#include <Eigen/Core>

namespace mortise::parametric {

struct OrientedBox {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();     // m
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();   // columns: unit vectors
  Eigen::Vector3d half_size = Eigen::Vector3d::Zero();  // m
};

// Whether axes are those of space, in any order and either way. The comparison is exact, as
// rotations by right angles are made without rounding.
bool IsAtRightAngles(const Eigen::Matrix3d& axes);

// The direction along which two boxes are furthest apart.
struct SeparatingAxis {
  Eigen::Vector3d direction =
      Eigen::Vector3d::UnitX();  // unit vector, from the first to the second
  double distance = 0;           // m between them along it
};

// Finds the direction along which two boxes are furthest apart, by separating axes (Gottschalk et
// al. 1996). If the boxes intersect, the distance is minus how far one must be moved to be free,
// which is exact; if not, it is never above the true distance.
SeparatingAxis FindSeparatingAxis(const OrientedBox& a, const OrientedBox& b);

// Returns a point in the middle of what two boxes have in common, if they are apart by no more than
// `tolerance`, m; else a point between them.
Eigen::Vector3d CommonPoint(const OrientedBox& a, const OrientedBox& b, double tolerance);

// Returns the distance of FindSeparatingAxis, m.
double Separation(const OrientedBox& a, const OrientedBox& b);

}  // namespace mortise::parametric
