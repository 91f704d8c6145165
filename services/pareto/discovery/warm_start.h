// Chooses designs of earlier fronts for a discovery to begin with.
//
// When a bound or a metric changes the new front is often near the old one: its designs, evaluated
// for the new problem, save what it took to find them. Nothing else of the old front is believed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/pareto/archive/evaluation.h"

namespace mortise::pareto {

// The points of an earlier front, with the parameters of the new problem.
struct EarlierFront {
  Eigen::MatrixXd designs;  // D x n, SI units, finite; may lie outside the new bounds
  Eigen::MatrixXd metrics;  // d x n of the old front, all minimised
};

// Returns how many designs of earlier fronts a discovery begins with, at most: 24 for two metrics,
// four times as many for each further one, and no more than an eighth of the evaluations. So many
// tell where the front goes; more would leave too little for finding out that it is elsewhere now.
std::int64_t MostStartDesigns(std::int64_t evaluations, Eigen::Index metric_count);

// Returns the designs of the fronts, brought into the bounds of `space` and to its steps, none
// twice: D x n, n <= most. If they are more than `most`, it takes as many of each front, spread
// along it, in this order: first the best of each metric, then always the one whose metrics (in
// units of their ranges) are furthest from those of all before. O(n most d) for each front.
Eigen::MatrixXd StartDesigns(const DesignSpace& space, const std::vector<EarlierFront>& fronts,
                             std::int64_t most);

}  // namespace mortise::pareto
