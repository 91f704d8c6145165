// Says where on the front a trade-off is: the direction in which it lies from the ideal (§7.5.1),
// as d - 1 coordinates to explore the front by.
//
// A scaled performance y >= 0 has hyperspherical angles phi_k = atan2(|(y_{k+1}, ..., y_d)|, y_k);
// its embedding is 2 phi / pi, in [0, 1]^(d-1). Angles say little of each other where they meet (at
// phi_1 = 0 all others are the same place), so nearness is measured between rays.
#pragma once

#include <Eigen/Core>

namespace mortise::pareto {

// Returns the embedding, d - 1, of a scaled performance (d); coordinates below 0 count as 0.
Eigen::VectorXd Embed(const Eigen::VectorXd& scaled);

// Returns the unit vectors from the ideal, d x n, at positions of an embedding, d - 1 x n.
Eigen::MatrixXd RaysAt(const Eigen::MatrixXd& embedding);

// Returns how many neighbours a point of a front of d > 2 metrics has: 6, 8, 10, 12 for d = 3, 4,
// 5, 6.
int NeighboursOnFront(Eigen::Index d);

}  // namespace mortise::pareto
