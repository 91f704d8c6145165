// Computes the hypervolume indicator: how much of performance space a set of points dominates.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::pareto {

inline constexpr Eigen::Index kMaxMetrics = 6;

// Returns the measure of { y : p <= y <= reference for some p in points }, exactly, for d of 1 to 6
// metrics (minimised). Points that are not below `reference` in every metric add nothing, nor do
// dominated ones.
//
// d = 2 and 3 are sweeps in O(n log n). Above that each point adds what it dominates alone among
// those that are better in the last metric, of which most are dominated once they are limited to
// its box (While, Bradstreet and Barone, "A fast way of calculating exact hypervolumes", 2012).
// That is quick enough for some thousand points of four metrics and some hundred of six; see
// QuickHypervolume.
double Hypervolume(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& reference);

// Returns the hypervolume that `point` adds to that of `points` (d x n, a column each): its box,
// less the part of it that these dominate. It is 0 where the point adds nothing.
//
// It takes O(n), and beyond that the time that the points need which are not dominated by another
// one in the box of `point`. With `most` > 0 only so many of those are taken into account, the ones
// that cover most of the box: a bound from above, which for d >= 5 is what a running measure can
// afford.
double HypervolumeContribution(const Eigen::VectorXd& point,
                               const Eigen::Ref<const Eigen::MatrixXd>& points,
                               const Eigen::VectorXd& reference, std::size_t most = 0);

// Estimates the hypervolume by how many of `samples` evenly spread places of the box from the best
// of each metric to `reference` are dominated. The estimate is the same for the same points in any
// order, and off by some 1 / sqrt(samples) of the box at most. O(n samples).
double SampledHypervolume(const std::vector<Eigen::VectorXd>& points,
                          const Eigen::VectorXd& reference, int samples);

// Computes the hypervolume exactly where that is quicker than with so many samples, else by
// samples. It is always exact for d <= 3; with 2^18 samples for some 16,000 points of four metrics,
// 3,000 of five and 300 of six.
double QuickHypervolume(const std::vector<Eigen::VectorXd>& points,
                        const Eigen::VectorXd& reference, int samples = 1 << 18);

}  // namespace mortise::pareto
