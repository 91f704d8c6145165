// Learns from all combinations how much each value of a discrete parameter adds to each metric.
//
// f(c, u) ~ a + sum_k e_k[c_k] + b . u + c . u^2, by least squares with a small ridge, over
// evaluations in scaled metrics. Where values act together the sum is off, but the differences
// between combinations that have much in common are often about right. They are used to choose
// which combination to try next, and where.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/pareto/models/combinations.h"

namespace mortise::pareto {

class CombinationModel {
 public:
  struct Sample {
    const Combination* combination = nullptr;
    Eigen::VectorXd u;        // other parameters, unit coordinates
    Eigen::VectorXd metrics;  // d, scaled
  };

  // Fits the model to `samples`, of which there is at least one. O(n p^2 + p^3) for p values and
  // parameters.
  CombinationModel(const std::vector<DiscreteParameter>& discrete,
                   const std::vector<Sample>& samples);

  // Returns how much the metrics change, d, if all else stays the same.
  Eigen::VectorXd Difference(const Combination& from, const Combination& to) const;

 private:
  std::vector<Eigen::Index> first_;  // row of the first value of each discrete parameter
  Eigen::MatrixXd effects_;          // a row a value, a column a metric
};

}  // namespace mortise::pareto
