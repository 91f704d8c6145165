// The hypervolume indicator: how much of performance space a set of points dominates.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::pareto {

// The measure of { y : p <= y <= reference for some p in points }, exactly, for any number of
// metrics d (minimised). Points that are not below `reference` in every metric add nothing.
//
// d = 2 is a sweep in O(n log n). For d > 2 the last metric is swept and each slab measured in d -
// 1 dimensions, O(n^(d-1) log n): exact, and quick enough for d = 3 and some thousand points.
double Hypervolume(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& reference);

}  // namespace mortise::pareto
