// Looks for a near point in the 27 grid cells around.
#include "common/mesh/point_merger.h"

#include <cmath>

namespace mortise::mesh {

std::size_t PointMerger::CellHash::operator()(const Cell& cell) const {
  std::uint64_t hash = 0;
  for (const std::int64_t coordinate : cell) {
    hash = (hash ^ static_cast<std::uint64_t>(coordinate)) * 0x9E3779B97F4A7C15ull;
    hash ^= hash >> 29;
  }
  return static_cast<std::size_t>(hash);
}

int PointMerger::IndexOf(const Eigen::Vector3d& point) {
  Cell centre;
  for (int i = 0; i < 3; ++i) {
    centre[static_cast<std::size_t>(i)] =
        static_cast<std::int64_t>(std::floor(point(i) / tolerance_));
  }
  for (int offset = 0; offset < 27; ++offset) {
    const Cell cell = {centre[0] + offset % 3 - 1, centre[1] + offset / 3 % 3 - 1,
                       centre[2] + offset / 9 - 1};
    const auto found = cells_.find(cell);
    if (found == cells_.end()) continue;
    for (const int index : found->second) {
      if ((points_[static_cast<std::size_t>(index)] - point).norm() <= tolerance_) return index;
    }
  }
  const int index = static_cast<int>(points_.size());
  points_.push_back(point);
  cells_[centre].push_back(index);
  return index;
}

Eigen::Matrix3Xd PointMerger::Points() const {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    result.col(static_cast<Eigen::Index>(i)) = points_[i];
  }
  return result;
}

}  // namespace mortise::mesh
