// Patches of surfaces for tests of what flattens them.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "services/interpolator/mapping/disk_map.h"

namespace mortise::interpolator {

// A square of cells², divided along random diagonals, its vertices moved at random by up to a share
// of a cell across and by as much as two cells in height.
inline DiskPatch RandomPatch(std::mt19937& random, int cells, double share) {
  std::uniform_real_distribution<double> noise(-1, 1);
  DiskPatch patch;
  const int side = cells + 1;
  patch.vertices.resize(3, side * side);
  patch.triangles.resize(3, 2 * cells * cells);
  for (int i = 0; i < side; ++i) {
    for (int k = 0; k < side; ++k) {
      patch.vertices.col(i * side + k) << i + share * noise(random), k + share * noise(random),
          5 * share * noise(random);
    }
  }
  Eigen::Index next = 0;
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      const int a = i * side + k, b = a + side, c = b + 1, d = a + 1;
      if (noise(random) > 0) {
        patch.triangles.col(next++) << a, b, c;
        patch.triangles.col(next++) << a, c, d;
      } else {
        patch.triangles.col(next++) << a, b, d;
        patch.triangles.col(next++) << b, c, d;
      }
    }
  }
  for (int i = 0; i < cells; ++i) patch.boundary.push_back(i * side);
  for (int i = 0; i < cells; ++i) patch.boundary.push_back(cells * side + i);
  for (int i = 0; i < cells; ++i) patch.boundary.push_back((cells - i) * side + cells);
  for (int i = 0; i < cells; ++i) patch.boundary.push_back(cells - i);
  return patch;
}

// Where the boundary of a patch goes on the unit circle, at equal distances.
inline Eigen::Matrix2Xd OnCircle(const DiskPatch& patch) {
  const auto count = static_cast<Eigen::Index>(patch.boundary.size());
  Eigen::Matrix2Xd circle(2, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(count);
    circle.col(i) << std::cos(angle), std::sin(angle);
  }
  return circle;
}

}  // namespace mortise::interpolator
