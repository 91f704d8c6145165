// Sorts points so that neighbours in the order are near each other in space. Private to this
// folder.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::interpolator {

// Sorts indices of points, 3 × N, by their places along Hilbert's curve through the box of all
// points (J. Skilling, Programming the Hilbert curve, 2004), with 2²¹ steps a side. Points at one
// place stay in their order.
void SortInSpace(const Eigen::Matrix3Xd& points, std::vector<int>& indices);

}  // namespace mortise::interpolator
