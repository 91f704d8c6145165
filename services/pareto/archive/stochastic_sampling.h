// Draws where the next local optimisations start (§7.5.2, Stochastic Sampling).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/base/random.h"

namespace mortise::pareto {

// Returns a Latin hypercube of `count` points in [0, 1)^D: each coordinate takes one value in each
// of `count` equal strata, in an order of its own.
std::vector<Eigen::VectorXd> LatinHypercube(std::int64_t count, Eigen::Index size, Random& random);

// Returns x_s = x_j + 2^(-delta) d, clamped to the box, in unit coordinates: d is uniform on the
// sphere of R^D (both signs in every coordinate), delta uniform in [0, delta_p]. Small steps
// exploit and are frequent, large ones explore; delta_p = 10 in the thesis.
Eigen::VectorXd PerturbedSample(const Eigen::VectorXd& u, double delta_p, Random& random);

}  // namespace mortise::pareto
