#include "common/assembly/model/oriented_box.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace mortise::parametric {
namespace {

constexpr int kProjections = 300;   // the error halves with every few
constexpr double kParallel = 1e-9;  // length of the cross product of edges that give no direction

// Half the extent of a box along a unit vector.
double Reach(const OrientedBox& box, const Eigen::Vector3d& direction) {
  return (box.axes.transpose() * direction).cwiseAbs().dot(box.half_size);
}

Eigen::Vector3d NearestIn(const OrientedBox& box, const Eigen::Vector3d& point) {
  const Eigen::Vector3d local = box.axes.transpose() * (point - box.center);
  return box.center + box.axes * local.cwiseMax(-box.half_size).cwiseMin(box.half_size);
}

// The ends of what lies within `of` of the segment from `from` to `to`.
void AddSegmentWithin(const OrientedBox& of, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                      double tolerance, std::vector<Eigen::Vector3d>& ends) {
  const Eigen::Vector3d start = of.axes.transpose() * (from - of.center);
  const Eigen::Vector3d along = of.axes.transpose() * (to - from);
  double low = 0, high = 1;  // shares of the segment
  for (int axis = 0; axis < 3; ++axis) {
    const double reach = of.half_size[axis] + tolerance;
    if (along[axis] == 0) {
      if (std::abs(start[axis]) > reach) return;
      continue;
    }
    const double first = (-reach - start[axis]) / along[axis];
    const double second = (reach - start[axis]) / along[axis];
    low = std::max(low, std::min(first, second));
    high = std::min(high, std::max(first, second));
  }
  if (low > high) return;
  ends.push_back(from + low * (to - from));
  ends.push_back(from + high * (to - from));
}

// Of each edge of `box`.
void AddEdgesWithin(const OrientedBox& box, const OrientedBox& of, double tolerance,
                    std::vector<Eigen::Vector3d>& ends) {
  const auto corner = [&](int which) -> Eigen::Vector3d {
    const Eigen::Vector3d sides(which & 1 ? 1 : -1, which & 2 ? 1 : -1, which & 4 ? 1 : -1);
    return box.center + box.axes * sides.cwiseProduct(box.half_size);
  };
  for (int which = 0; which < 8; ++which) {
    for (const int bit : {1, 2, 4}) {
      if ((which & bit) != 0) continue;
      AddSegmentWithin(of, corner(which), corner(which | bit), tolerance, ends);
    }
  }
}

}  // namespace

bool IsAtRightAngles(const Eigen::Matrix3d& axes) {
  return (axes.array().abs() == 0 || axes.array().abs() == 1).all();
}

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

Eigen::Vector3d CommonPoint(const OrientedBox& a, const OrientedBox& b, double tolerance) {
  std::vector<Eigen::Vector3d> corners;  // of what they have in common, some twice
  AddEdgesWithin(a, b, tolerance, corners);
  AddEdgesWithin(b, a, tolerance, corners);
  if (corners.empty()) return (NearestIn(a, b.center) + NearestIn(b, a.center)) / 2;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : corners) sum += corner;
  return sum / static_cast<double>(corners.size());
}

double Separation(const OrientedBox& a, const OrientedBox& b) {
  return FindSeparatingAxis(a, b).distance;
}

}  // namespace mortise::parametric
