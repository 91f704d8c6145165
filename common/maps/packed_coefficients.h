// The coefficients of a map packed for each element and level, as they are read when a point is
// evaluated. A part of InterpolationMap (interpolation_map.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/maps/basis.h"
#include "common/maps/refinement_tree.h"

namespace mortise::maps {

class PackedCoefficients {
 public:
  PackedCoefficients() = default;
  // coefficients: as of ComputeCoefficients.
  PackedCoefficients(const RefinementTree& tree, const Eigen::MatrixXd& coefficients);

  // P(x) over the element at a point in it: writes as many numbers as there are outputs to
  // `values`, and outputs · K to `gradient` unless it is null.
  void Evaluate(int element, const double* point, double* values, double* gradient) const;

  // The bytes that all elements take.
  std::size_t bytes() const;
  // The bytes among them that Evaluate reads.
  std::size_t BytesRead(int element, const double* point) const;

 private:
  // Centres of one level over one element: a grid, zero where no B-spline is active.
  struct Block {
    int level = 0;
    std::array<std::int32_t, kMostDirections> low{};     // of the first centre, in its spacing
    std::array<std::int32_t, kMostDirections> count{};   // of centres
    std::array<std::int32_t, kMostDirections> stride{};  // in doubles
    std::size_t first = 0;                               // in numbers_
  };
  struct Range {
    int first = 0;
    int end = 0;
  };
  struct Placed {
    int element = 0;
    int level = 0;
    int spline = 0;
  };
  class Sum;

  void Pack(const RefinementTree& tree, const Eigen::MatrixXd& coefficients,
            std::vector<int> group);

  int dimension_ = 0;
  int outputs_ = 0;
  Basis basis_ = Basis::kLinear;
  std::vector<Range> ranges_;  // of blocks_, for each node
  std::vector<Block> blocks_;
  std::vector<double> numbers_;
};

}  // namespace mortise::maps
