// What a saw needs of parts with sloped ends that lie behind each other on a board, by arithmetic
// on the corners of their ends that shares nothing with the planner.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "services/fabplanner/plan/end_cuts.h"

namespace mortise::fabplanner {

constexpr double kRounding = 5e-6;  // m; ends that run alike within a micrometre share a cut

// Where the ends of a part lie on the four corner lines of a board.
struct Corners {
  std::array<double, 4> front, rear;

  double First() const { return *std::min_element(front.begin(), front.end()); }
  double Last() const { return *std::max_element(rear.begin(), rear.end()); }
};

inline double AtCorner(const EndSlope& end, int corner, const Eigen::Vector2d& section) {
  return (corner % 2 == 0 ? -0.5 : 0.5) * end.across * section.x() +
         (corner < 2 ? -0.5 : 0.5) * end.through * section.y();
}

// The part with its foremost point at `start`.
inline Corners CornersOf(const CutEnds& ends, double start, double length,
                         const Eigen::Vector2d& section) {
  Corners corners;
  double first = 1e9, last = -1e9;
  for (int i = 0; i < 4; ++i) {
    corners.front[i] = AtCorner(ends.front, i, section);
    corners.rear[i] = AtCorner(ends.rear, i, section);
    first = std::min(first, corners.front[i]);
    last = std::max(last, corners.rear[i]);
  }
  for (int i = 0; i < 4; ++i) {
    corners.front[i] += start - first;
    corners.rear[i] += start + length - last;
  }
  return corners;
}

// Whether a saw parts the two: its blade runs along one of the two ends, or square between them,
// and enters neither part.
inline bool ArePartedBySaw(const Corners& before, const CutEnds& ends_before, const Corners& behind,
                           const CutEnds& ends_behind, double kerf) {
  const auto blade_fits = [&](const EndSlope& end) {
    const double across_blade =
        1 / std::sqrt(1 + end.across * end.across + end.through * end.through);
    double least = 1e9;
    for (int i = 0; i < 4; ++i) least = std::min(least, behind.front[i] - before.rear[i]);
    return least * across_blade >= kerf - kRounding;
  };
  return blade_fits(ends_before.rear) || blade_fits(ends_behind.front) ||
         behind.First() - before.Last() >= kerf - kRounding;
}

}  // namespace mortise::fabplanner
