// The dyadic lattice of the unit box on which corners of elements, samples and centres of B-splines
// lie. Their positions are integers, so that equality and order of positions are exact.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

namespace mortise::maps {

// The most directions (parameters) of a map: an element of K directions has 2^K corners.
inline constexpr int kMostDirections = 10;
// The edge of the unit box in lattice units is 2^kLatticeLevels.
inline constexpr int kLatticeLevels = 24;
inline constexpr std::int32_t kBoxEdge = 1 << kLatticeLevels;

// A position in lattice units. Directions that a map does not have are zero. Centres of cubic
// B-splines may lie outside of the box.
using LatticePoint = std::array<std::int32_t, kMostDirections>;

// The closed cuboid from `low` to `high`; it may be flat in some directions.
struct LatticeBox {
  LatticePoint low{};
  LatticePoint high{};
};

// A point whose coordinates are rational: coordinate d is numerator[d] / denominator lattice units.
struct RationalPoint {
  std::array<std::int64_t, kMostDirections> numerator{};
  std::int64_t denominator = 1;
};

// A centre with the level of its B-spline. The distance of centres at level j is 2^-j of the box.
struct LeveledPoint {
  int level = 0;
  LatticePoint centre{};

  bool operator==(const LeveledPoint&) const = default;
};

// The distance of neighbouring centres of level `level`, in lattice units.
inline std::int32_t SpacingOf(int level) { return kBoxEdge >> level; }

// A coordinate of the unit box as a number from 0 to 1.
inline double ToUnit(std::int32_t coordinate) { return static_cast<double>(coordinate) / kBoxEdge; }

// A position in the unit box.
inline Eigen::VectorXd UnitPosition(const LatticePoint& point, int dimension) {
  Eigen::VectorXd position(dimension);
  for (int d = 0; d < dimension; ++d) position[d] = ToUnit(point[d]);
  return position;
}

struct LatticeHash {
  std::size_t operator()(const LatticePoint& point) const {
    std::uint64_t hash = 0x9e3779b97f4a7c15U;
    for (const std::int32_t coordinate : point) {
      hash = (hash ^ static_cast<std::uint32_t>(coordinate)) * 0xff51afd7ed558ccdU;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
  std::size_t operator()(const LeveledPoint& point) const {
    return (*this)(point.centre) * 31 + static_cast<std::size_t>(point.level);
  }
};

// Calls visit(point) for every point of the grid from `low` to `high` (both included) with `step`
// in each of the first `dimension` directions; the last direction runs fastest.
template <typename Visit>
void ForEachGridPoint(int dimension, const LatticeBox& box, const LatticePoint& step,
                      const Visit& visit) {
  LatticePoint point = box.low;
  for (int d = 0; d < dimension; ++d) {
    if (box.low[d] > box.high[d]) return;
  }
  while (true) {
    visit(static_cast<const LatticePoint&>(point));
    int d = dimension - 1;
    for (; d >= 0; --d) {
      point[d] += step[d];
      if (point[d] <= box.high[d]) break;
      point[d] = box.low[d];
    }
    if (d < 0) return;
  }
}

}  // namespace mortise::maps
