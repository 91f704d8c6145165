// Designs near the front, pushed on to it as far as is known without evaluating anything.
//
// Around a design u that is nearly Pareto-optimal, quadratic models (quadratic_model.h) of what has
// been evaluated nearby tell a direction -alpha normal to the front (first_order_expansion.h), and
// a step p that brings the performance towards a point just beyond the front, as in the thesis's
// measure of how far a design is from it (Eq. 7.8):
//
//   min over p of |y(u + p) - (y(u) - delta_N alpha / |alpha|)|^2,   y the scaled performance,
//
// and then back along the front to the ray from the ideal through y(u), so that it stays in its
// cell of the performance buffer and takes the place of u.
//
// The models are good where the front is well sampled, so that the step costs one evaluation and
// takes the error of half way between two designs from the square of their distance to about its
// fourth power.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/pareto/archive.h"
#include "services/pareto/performance_buffer.h"

namespace mortise::pareto {

struct PolishedDesign {
  Eigen::VectorXd u;  // D, within the unit box; bounds that the design was on are kept
  double gain = 0;    // towards the ideal along the normal, as predicted; scaled performance
};

// `u` moved by p, no coordinate by more than `reach`. Needs an evaluated entry. O(D^3).
PolishedDesign Polished(const Archive& archive, const Scaling& scaling, const Eigen::VectorXd& u,
                        double reach);

// The best designs of the cells of `buffer` that gain most by it, at most `count`, those that gain
// most first; none of those that gain next to nothing.
std::vector<Eigen::VectorXd> PolishedFront(const Archive& archive, const PerformanceBuffer& buffer,
                                           std::size_t count);

}  // namespace mortise::pareto
