// Fits circles through points of a plane, as the corners of triangles in round faces lie.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace mortise::mesh {

struct Circle {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // m
  double radius = 0;                                 // m
};

// Returns the circle on which at least half of the points, 2 × N in metres, lie to rounding, and
// all others to a micrometre: where two curved faces meet, the CAD kernel knows their edge only
// within its tolerance. Returns none if there is no such circle, or they lie in a line. It is found
// by least squares (Kåsa 1976).
std::optional<Circle> CircleThrough(const Eigen::Matrix2Xd& points);

}  // namespace mortise::mesh
