// The null space of a matrix whose rows have few entries and are about 1 long.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

namespace mortise::simulator {

struct NullSpace {
  int dimension = 0;
  Eigen::MatrixXd basis;  // columns × dimension, orthonormal; at most `most` of them
};

// Vectors that the rows take to less than `tolerance` times their length: exactly, by the
// eigenvalues of the rows' Gram matrix, or where that is large by counting the signs of its shifted
// pivots (Sylvester's law of inertia) and as many vectors by inverse iteration.
NullSpace FindNullSpace(const Eigen::SparseMatrix<double>& rows, double tolerance, int most);

}  // namespace mortise::simulator
