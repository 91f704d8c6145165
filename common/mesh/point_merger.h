// Gives points that are the same up to a tolerance one index.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace mortise::mesh {

// Points nearer than the tolerance are one. They are found by a hash of grid cells as wide as the
// tolerance.
class PointMerger {
 public:
  explicit PointMerger(double tolerance) : tolerance_(tolerance) {}

  // Returns the index of `point`, which becomes a new one if none is near.
  int IndexOf(const Eigen::Vector3d& point);

  // Returns all points so far, 3 × N.
  Eigen::Matrix3Xd Points() const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const;
  };

  double tolerance_;
  std::vector<Eigen::Vector3d> points_;
  std::unordered_map<Cell, std::vector<int>, CellHash> cells_;
};

}  // namespace mortise::mesh
