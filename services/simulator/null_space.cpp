#include "services/simulator/null_space.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace mortise::simulator {
namespace {

// Up to so many columns all eigenvalues are found, which takes a second at most.
constexpr Eigen::Index kDense = 600;

// Each round of inverse iteration takes what is not in the null space down to a hundredth at least.
constexpr int kRounds = 8;

using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

Eigen::SparseMatrix<double> Shifted(const Eigen::SparseMatrix<double>& matrix, double shift) {
  Eigen::SparseMatrix<double> identity(matrix.rows(), matrix.cols());
  identity.setIdentity();
  return matrix + shift * identity;
}

// How many eigenvalues lie below `bound`. A shift that happens to be an eigenvalue of some leading
// part of the matrix, which leaves a pivot of zero, is moved.
int CountBelow(const Eigen::SparseMatrix<double>& gram, double bound) {
  for (int attempt = 0; attempt < 5; ++attempt) {
    const Factor factor(Shifted(gram, -bound * (1 + 0.01 * attempt)));
    if (factor.info() != Eigen::Success) continue;
    return static_cast<int>((factor.vectorD().array() < 0).count());
  }
  return 0;
}

NullSpace FindLarge(const Eigen::SparseMatrix<double>& gram, double bound, int most) {
  NullSpace space;
  space.dimension = CountBelow(gram, bound);
  const int count = std::min(space.dimension, most);
  if (count == 0) return space;
  const Factor factor(Shifted(gram, 0.01 * bound));
  Eigen::MatrixXd block(gram.cols(), count);
  double seed = 0.5;
  for (double& value : block.reshaped()) {
    seed = std::fmod(seed * 997 + 0.618033988749895, 1.0);
    value = seed - 0.5;
  }
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::HouseholderQR<Eigen::MatrixXd> orthogonal(factor.solve(block));
    block = orthogonal.householderQ() * Eigen::MatrixXd::Identity(gram.cols(), count);
  }
  space.basis = std::move(block);
  return space;
}

}  // namespace

NullSpace FindNullSpace(const Eigen::SparseMatrix<double>& rows, double tolerance, int most) {
  const Eigen::SparseMatrix<double> gram = rows.transpose() * rows;
  const double bound = tolerance * tolerance;
  if (gram.cols() > kDense) return FindLarge(gram, bound, most);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{Eigen::MatrixXd(gram)};
  NullSpace space;
  space.dimension = static_cast<int>((eigen.eigenvalues().array() < bound).count());
  space.basis = eigen.eigenvectors().leftCols(std::min(space.dimension, most));
  return space;
}

}  // namespace mortise::simulator
