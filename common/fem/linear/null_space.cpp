#include "common/fem/linear/null_space.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace mortise::simulator {
namespace {

// Up to so many columns all eigenvalues are found, which takes a second at most.
constexpr Eigen::Index kDense = 600;

// Each round of inverse iteration takes what is not in the null space down to a hundredth at least.
constexpr int kRounds = 8;

// Rounds for vectors that are right but for the rounding of the Gram matrix.
constexpr int kPolishing = 2;

// The slip that any vector has of itself, as rounding leaves so much of its misfits: 1e-13 of the
// vector, divided by a tolerance of 1e-5.
constexpr double kRounding = 1e-8;

using Sparse = Eigen::SparseMatrix<double>;
using Factor = Eigen::SimplicialLDLT<Sparse>;

Sparse Shifted(const Sparse& matrix, double shift) {
  Sparse identity(matrix.rows(), matrix.cols());
  identity.setIdentity();
  return matrix + shift * identity;
}

// The largest that the square of any vector's slips can be, or a little more.
double LargestSlip(const Sparse& slips) {
  const Sparse gram = slips.transpose() * slips;
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(gram.cols());
  for (Eigen::Index c = 0; c < gram.outerSize(); ++c) {
    for (Sparse::InnerIterator entry(gram, c); entry; ++entry) sums[c] += std::abs(entry.value());
  }
  return (sums.size() > 0 ? sums.maxCoeff() : 0) + kRounding * kRounding;
}

// How many eigenvalues lie below `bound`. A shift that happens to be an eigenvalue of some leading
// part of the matrix, which leaves a pivot of zero, is moved.
int CountBelow(const Sparse& gram, double bound) {
  for (int attempt = 0; attempt < 5; ++attempt) {
    const Factor factor(Shifted(gram, -bound * (1 + 0.01 * attempt)));
    if (factor.info() != Eigen::Success) continue;
    return static_cast<int>((factor.vectorD().array() < 0).count());
  }
  return 0;
}

Eigen::MatrixXd Orthonormal(const Eigen::MatrixXd& block) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> orthogonal(block);
  return orthogonal.householderQ() * Eigen::MatrixXd::Identity(block.rows(), block.cols());
}

Eigen::MatrixXd StartBlock(Eigen::Index size, Eigen::Index count) {
  Eigen::MatrixXd block(size, count);
  double seed = 0.5;
  for (double& value : block.reshaped()) {
    seed = std::fmod(seed * 997 + 0.618033988749895, 1.0);
    value = seed - 0.5;
  }
  return block;
}

// Inverse iteration. What each round takes away follows from the misfits, not from the vectors, so
// that misfits become as small as their own rounding.
Eigen::MatrixXd Iterated(const Sparse& misfits, const Factor& factor, Eigen::MatrixXd block,
                         int rounds) {
  for (int round = 0; round < rounds; ++round) {
    const Eigen::MatrixXd rest = misfits * block;
    block = Orthonormal(block - factor.solve(misfits.transpose() * rest));
  }
  return block;
}

// Orthonormal combinations of the columns of a basis, which is orthonormal, that span those whose
// misfits are smaller than their slips: in the basis in which both together are orthonormal, those
// whose misfits are less than half.
Eigen::MatrixXd Slipping(const Eigen::MatrixXd& misfits, const Eigen::MatrixXd& slips) {
  const Eigen::Index count = misfits.cols();
  Eigen::MatrixXd all(misfits.rows() + slips.rows() + count, count);
  all << misfits, slips, kRounding * Eigen::MatrixXd::Identity(count, count);
  const Eigen::HouseholderQR<Eigen::MatrixXd> together(all);
  const Eigen::MatrixXd triangle =
      together.matrixQR().topRows(count).triangularView<Eigen::Upper>();
  const Eigen::MatrixXd shares =
      triangle.transpose().triangularView<Eigen::Lower>().solve(misfits.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(shares * shares.transpose());
  const Eigen::Index slipping = (eigen.eigenvalues().array() < 0.5).count();
  if (slipping == count) return Eigen::MatrixXd::Identity(count, count);
  if (slipping == 0) return Eigen::MatrixXd(count, 0);
  // They are orthogonal to what the others are there.
  const Eigen::HouseholderQR<Eigen::MatrixXd> others(
      triangle.transpose() * eigen.eigenvectors().rightCols(count - slipping));
  const Eigen::MatrixXd directions =
      others.householderQ() * Eigen::MatrixXd::Identity(count, count);
  return directions.rightCols(slipping);
}

}  // namespace

NullSpace FindNullSpace(const JointRows& rows, int most) {
  const Sparse gram = rows.misfits.transpose() * rows.misfits;
  const double bound = LargestSlip(rows.slips);
  const Factor factor(Shifted(gram, 0.01 * bound));
  const bool is_dense = gram.cols() <= kDense;
  Eigen::MatrixXd soft;  // all of them, where the matrix is small
  int count = 0;
  if (is_dense) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{Eigen::MatrixXd(gram)};
    count = static_cast<int>((eigen.eigenvalues().array() < bound).count());
    soft = eigen.eigenvectors().leftCols(count);
  } else {
    count = CountBelow(gram, bound);
  }
  NullSpace space;
  space.basis.resize(gram.cols(), 0);
  if (count == 0) return space;
  // As few of them as are enough: where the first ones are all free, more need not be looked at.
  for (int tried = is_dense ? count : std::min(count, most);; tried = std::min(count, 4 * tried)) {
    soft =
        Iterated(rows.misfits, factor, is_dense ? std::move(soft) : StartBlock(gram.cols(), tried),
                 is_dense ? kPolishing : kRounds);
    space.basis = soft * Slipping(rows.misfits * soft, rows.slips * soft);
    space.dimension = static_cast<int>(space.basis.cols());
    if (tried == count) break;
    if (space.dimension == tried) {
      space.dimension = count;
      break;
    }
  }
  space.basis = space.basis.leftCols(std::min(space.dimension, most)).eval();
  return space;
}

}  // namespace mortise::simulator
