// Pareto dominance (definition in §7.3.1), for minimised metrics.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace mortise::pareto {

// Whether `a` is at least as good as `b` in every metric and better in one.
bool Dominates(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

// Returns the indices, ascending, of the points that no other point dominates. Of equal points the
// first is kept.
std::vector<std::size_t> NonDominated(const std::vector<Eigen::VectorXd>& points);

}  // namespace mortise::pareto
