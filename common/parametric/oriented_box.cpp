#include "common/parametric/oriented_box.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace mortise::parametric {
namespace {

constexpr double kParallel = 1e-9;  // length of the cross product of edges that give no direction

// Half the extent of a box along a unit vector.
double Reach(const OrientedBox& box, const Eigen::Vector3d& direction) {
  return (box.axes.transpose() * direction).cwiseAbs().dot(box.half_size);
}

}  // namespace

SeparatingAxis FindSeparatingAxis(const OrientedBox& a, const OrientedBox& b) {
  SeparatingAxis best;
  best.distance = -std::numeric_limits<double>::infinity();
  const auto look_along = [&](const Eigen::Vector3d& direction) {
    const double between = direction.dot(b.center - a.center);
    const double distance = std::abs(between) - Reach(a, direction) - Reach(b, direction);
    if (distance <= best.distance) return;
    best.distance = distance;
    best.direction = between < 0 ? Eigen::Vector3d(-direction) : direction;
  };
  for (int i = 0; i < 3; ++i) look_along(a.axes.col(i));
  if (a.axes == b.axes) return best;  // all other directions are the same
  for (int i = 0; i < 3; ++i) look_along(b.axes.col(i));
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d direction = a.axes.col(i).cross(b.axes.col(j));
      const double length = direction.norm();
      if (length > kParallel) look_along(direction / length);
    }
  }
  return best;
}

double Separation(const OrientedBox& a, const OrientedBox& b) {
  return FindSeparatingAxis(a, b).distance;
}

}  // namespace mortise::parametric
