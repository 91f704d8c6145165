// Dual variables and tangent directions of the front.
#include "services/pareto/models/first_order_expansion.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The point of least norm sqrt(alpha.G alpha) of the simplex, G = J_F J_F^T, by trying its faces.
// It is the null vector of J_F^T wherever that has no mixed signs.
VectorXd LeastNormOnSimplex(const MatrixXd& G) {
  const Index d = G.rows();
  VectorXd best = VectorXd::Constant(d, 1.0 / static_cast<double>(d));
  double least = std::numeric_limits<double>::infinity();
  const double damping = 1e-14 * std::max(G.trace(), 1e-300);
  for (unsigned face = 1; face < (1U << d); ++face) {
    std::vector<Index> on;
    for (Index i = 0; i < d; ++i) {
      if ((face >> i) & 1U) on.push_back(i);
    }
    MatrixXd part = G(on, on);
    part.diagonal().array() += damping;
    VectorXd weights = part.ldlt().solve(VectorXd::Ones(static_cast<Index>(on.size())));
    if (!weights.allFinite() || !(std::abs(weights.sum()) > 0)) continue;
    weights /= weights.sum();
    if (weights.minCoeff() < 0) continue;
    const double norm = weights.dot(G(on, on) * weights);
    if (norm < least) {
      least = norm;
      best.setZero();
      best(on) = weights;
    }
  }
  return best;
}

// +1 where moving inwards means increasing the coordinate.
double Inward(double u) { return u < 0.5 ? 1.0 : -1.0; }

// How strongly the metrics disagree about moving inwards along a held coordinate; 0 if all lose.
double Conflict(const MatrixXd& J, Index i, double u) {
  const VectorXd slope = J.col(i) * Inward(u);
  return slope.minCoeff() < 0 ? slope.norm() : 0.0;
}

// An orthonormal basis of the vectors that the rows of A take to 0.
MatrixXd NullSpace(const MatrixXd& A) {
  const Index n = A.cols();
  if (A.rows() == 0) return MatrixXd::Identity(n, n);
  const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeFullV);
  const VectorXd& sizes = svd.singularValues();
  Index rank = 0;
  while (rank < sizes.size() && sizes[rank] > 1e-9 * std::max(sizes[0], 1e-300)) ++rank;
  return svd.matrixV().rightCols(n - rank);
}

// Multipliers for the active constraints, and alpha; whether none is negative. The one that is most
// so is released.
bool SolveActive(const MatrixXd& J, const MatrixXd& normals, std::vector<Index>& active,
                 KktPoint& kkt) {
  const MatrixXd free_part = J(Eigen::all, kkt.free);
  const MatrixXd A = normals(active, kkt.free);
  kkt.tangent = NullSpace(A);
  const MatrixXd reduced = free_part * kkt.tangent;
  kkt.alpha = LeastNormOnSimplex(reduced * reduced.transpose());
  const double size = kkt.alpha.dot(free_part.rowwise().norm());
  kkt.residual = size > 0 ? (reduced.transpose() * kkt.alpha).norm() / size : 0.0;
  kkt.mu = VectorXd::Zero(normals.rows());
  if (active.empty()) return true;
  const VectorXd mu =
      A.transpose().completeOrthogonalDecomposition().solve(-(free_part.transpose() * kkt.alpha));
  Index least = 0;
  const double most_negative = mu.minCoeff(&least);
  const bool stuck = kkt.tangent.cols() == 0;
  if (most_negative < 0 || stuck) {
    active.erase(active.begin() + least);
    return false;
  }
  for (std::size_t k = 0; k < active.size(); ++k) kkt.mu[active[k]] = mu[static_cast<Index>(k)];
  return true;
}

void Solve(const MatrixXd& J, const MatrixXd& normals, KktPoint& kkt) {
  std::vector<Index> active(static_cast<std::size_t>(normals.rows()));
  std::iota(active.begin(), active.end(), Index{0});
  while (!SolveActive(J, normals, active, kkt)) {
  }
}

// Returns the parameter held at a bound that most metrics would move away from; -1 if none would.
Index MostConflicting(const MatrixXd& jacobian, const VectorXd& u,
                      const std::vector<bool>& is_free) {
  Index most = -1;
  double conflict = 0;
  for (Index i = 0; i < u.size(); ++i) {
    if (is_free[static_cast<std::size_t>(i)]) continue;
    const double here = Conflict(jacobian, i, u[i]);
    if (here > conflict) {
      conflict = here;
      most = i;
    }
  }
  return most;
}

}  // namespace

KktPoint RecoverDuals(const MatrixXd& jacobian, const VectorXd& u, const MatrixXd& normals,
                      double bound_tolerance) {
  const Index D = u.size();
  const Index d = jacobian.rows();
  const MatrixXd constraints = normals.rows() > 0 ? normals : MatrixXd(0, D);
  std::vector<bool> is_free(static_cast<std::size_t>(D));
  for (Index i = 0; i < D; ++i) {
    is_free[static_cast<std::size_t>(i)] = u[i] > bound_tolerance && u[i] < 1 - bound_tolerance;
  }
  KktPoint kkt;
  kkt.beta = VectorXd::Zero(D);
  const auto collect = [&] {
    kkt.free.clear();
    for (Index i = 0; i < D; ++i) {
      if (is_free[static_cast<std::size_t>(i)]) kkt.free.push_back(i);
    }
  };
  collect();
  while (static_cast<Index>(kkt.free.size()) < d - 1) {
    const Index most = MostConflicting(jacobian, u, is_free);
    if (most < 0) break;
    is_free[static_cast<std::size_t>(most)] = true;
    collect();
  }
  if (kkt.free.empty()) {
    kkt.alpha = VectorXd::Constant(d, 1.0 / static_cast<double>(d));
    kkt.residual = 0;
    kkt.mu = VectorXd::Zero(normals.rows());
    return kkt;
  }
  for (Index round = 0; round <= D; ++round) {
    Solve(jacobian, constraints, kkt);
    const VectorXd slope = jacobian.transpose() * kkt.alpha + constraints.transpose() * kkt.mu;
    const double small = 1e-3 * kkt.alpha.dot(jacobian.rowwise().norm());
    Index worst = -1;
    double least = -small;
    kkt.beta.setZero();
    for (Index i = 0; i < D; ++i) {
      if (is_free[static_cast<std::size_t>(i)]) continue;
      kkt.beta[i] = slope[i] * Inward(u[i]);
      if (kkt.beta[i] < least) {
        least = kkt.beta[i];
        worst = i;
      }
    }
    if (worst < 0) break;
    is_free[static_cast<std::size_t>(worst)] = true;
    collect();
  }
  kkt.beta = kkt.beta.cwiseMax(0.0);
  return kkt;
}

MatrixXd ExpansionDirections(const KktPoint& kkt, const MatrixXd& jacobian,
                             const MatrixXd& hessian) {
  const Index D = jacobian.cols();
  const auto free_count = static_cast<Index>(kkt.free.size());
  if (free_count == 0) return MatrixXd(D, 0);
  const Index wanted = std::min(jacobian.rows() - 1, kkt.tangent.cols());
  if (wanted <= 0) return MatrixXd(D, 0);
  const MatrixXd J = jacobian(Eigen::all, kkt.free) * kkt.tangent;
  const MatrixXd H = kkt.tangent.transpose() * hessian(kkt.free, kkt.free) * kkt.tangent;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(0.5 * (H + H.transpose()));
  const VectorXd magnitudes = eigen.eigenvalues().cwiseAbs();
  const double floor = std::max(1e-3 * magnitudes.maxCoeff(), 1e-12 * J.norm());
  MatrixXd image = J.transpose();
  if (floor > 0) {
    image = eigen.eigenvectors() * magnitudes.cwiseMax(floor).cwiseInverse().asDiagonal() *
            eigen.eigenvectors().transpose() * image;
  }
  const Eigen::JacobiSVD<MatrixXd> svd(image, Eigen::ComputeThinU);
  MatrixXd directions = MatrixXd::Zero(D, wanted);
  Index found = 0;
  for (Index k = 0; k < wanted; ++k) {
    if (!(svd.singularValues()[k] > 1e-9 * svd.singularValues()[0])) break;
    directions(kkt.free, k) = kkt.tangent * svd.matrixU().col(k);
    ++found;
  }
  return directions.leftCols(found);
}

}  // namespace mortise::pareto
