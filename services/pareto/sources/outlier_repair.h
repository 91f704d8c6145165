// Puts outliers among the trade-offs back in line (§7.5.4 calls for a clean-up of outliers; here
// the cleaned design is evaluated, so that it counts only if it is better).
//
// Along a piece of a front most parameters stay where they are or change slowly. A trade-off one of
// whose parameters lies far from those of its neighbours is mostly one that nothing has dominated
// yet; with that parameter set to theirs it is a better one.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/pareto/archive/archive.h"

namespace mortise::pareto {

// Returns up to `count` designs, in unit coordinates, those that were furthest out first:
// trade-offs of the archive with each parameter that differs from the median of their neighbours'
// by more than 0.0005 and four times the neighbours' interquartile range set to that median.
// Neighbours are the six trade-offs nearest in scaled performance for d = 2, four more for each
// further metric; no designs where there are fewer. O(n^2) at worst for n trade-offs, mostly a
// small part of it.
std::vector<Eigen::VectorXd> RepairedOutliers(const Archive& archive, const Scaling& scaling,
                                              std::size_t count);

}  // namespace mortise::pareto
