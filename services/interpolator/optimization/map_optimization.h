// Finds the best design on a map, where values cost microseconds (thesis §6.7.1).
//
// Each start is improved by sequential quadratic programming (SLSQP of NLopt), which follows the
// map's gradients (6.13), then by linear models without gradients (COBYLA of NLopt), which get past
// the kinks that a linear basis has at the faces of its elements. The thesis uses an interior point
// method; SLSQP holds the bounds just as exactly and needs no program beside ours.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "common/expressions/expression.h"

namespace mortise::interpolator {

// What a map of n parameters says of its m metrics at one point.
struct PointMetrics {
  Eigen::VectorXd metrics;    // m, SI units
  Eigen::MatrixXd gradients;  // m x n, by (6.13)
};

// Evaluates a map at a point of n parameters within its box. Gradients are wanted where the second
// argument says so, and may be empty otherwise. Whatever it fails with ends the optimisation, but
// OUT_OF_RANGE, which says that the map has nothing there.
using MapFunction =
    std::function<absl::StatusOr<PointMetrics>(const Eigen::VectorXd& parameters, bool gradients)>;

// What a metric must keep to, SI units; at least one of the two.
struct MetricLimit {
  Eigen::Index metric = 0;  // its number
  std::optional<double> minimum;
  std::optional<double> maximum;
};

struct MapOptimization {
  Eigen::VectorXd lower;   // n, SI units
  Eigen::VectorXd upper;   // n; the lower bound where a parameter is fixed
  Eigen::VectorXd ranges;  // m, above 0: how far each metric ranges over the map, SI units
  // What is minimised: over the n parameters and then the m metrics, in this order.
  parametric::Expression objective;
  bool maximize = false;  // that it is maximised instead
  std::vector<MetricLimit> limits;
  int starts = 16;         // seeded, spread over the box; the first is its middle
  std::uint64_t seed = 1;  // the same seed, the same result
};

struct MapOptimum {
  Eigen::VectorXd parameters;  // n
  Eigen::VectorXd metrics;     // m, by the map
  double objective = 0;
  // By how much limits are missed at the most, over what the metric ranges over the map; 0 where
  // all are kept.
  double violation = 0;
  int starts = 0;             // from how many places there was anything to search from
  int starts_that_agree = 0;  // how many of them ended within a thousandth of the box of it
};

// Returns the best point found that keeps all limits; the one that misses them least where none
// does (`violation` says so). INVALID_ARGUMENT where bounds are not finite or reversed, ranges are
// not above 0, there are no starts, or the objective cannot be computed at any of them, with its
// reason; OUT_OF_RANGE where the map has nothing at any start. Takes some hundred evaluations of
// the map for each start.
absl::StatusOr<MapOptimum> Optimize(const MapOptimization& problem, const MapFunction& map);

}  // namespace mortise::interpolator
