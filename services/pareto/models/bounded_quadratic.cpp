// Coordinate descent and projected Newton steps for quadratics over a box.
#include "services/pareto/models/bounded_quadratic.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace mortise::pareto {
namespace {

Eigen::MatrixXd PositivePart(const Eigen::MatrixXd& B) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(B);
  const double floor = 1e-10 * std::max(eigen.eigenvalues().cwiseAbs().maxCoeff(), 1e-300);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(floor).asDiagonal() *
         eigen.eigenvectors().transpose();
}

std::vector<Eigen::Index> Movable(const Eigen::VectorXd& p, const Eigen::VectorXd& gradient,
                                  const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  std::vector<Eigen::Index> movable;
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    const bool held =
        (p[i] <= lower[i] && gradient[i] >= 0) || (p[i] >= upper[i] && gradient[i] <= 0);
    if (!held) movable.push_back(i);
  }
  return movable;
}

// Minimises along each coordinate in turn. Unlike a projected Newton step this cannot fail to
// descend where a coordinate at its bound would have to follow another's.
void Sweep(const Eigen::VectorXd& g, const Eigen::MatrixXd& B, const Eigen::VectorXd& lower,
           const Eigen::VectorXd& upper, Eigen::VectorXd& p) {
  Eigen::VectorXd gradient = g + B * p;
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    if (!(B(i, i) > 0)) continue;
    const double moved = std::clamp(p[i] - gradient[i] / B(i, i), lower[i], upper[i]);
    gradient += (moved - p[i]) * B.col(i);
    p[i] = moved;
  }
}

}  // namespace

Eigen::VectorXd MinimizeBoundedQuadratic(const Eigen::VectorXd& g, const Eigen::MatrixXd& B,
                                         const Eigen::VectorXd& lower,
                                         const Eigen::VectorXd& upper) {
  const Eigen::MatrixXd convex = PositivePart(B);
  const auto value = [&](const Eigen::VectorXd& q) { return g.dot(q) + 0.5 * q.dot(convex * q); };
  Eigen::VectorXd p = Eigen::VectorXd::Zero(g.size());
  double best = 0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double before = best;
    Sweep(g, convex, lower, upper, p);
    best = value(p);
    const Eigen::VectorXd gradient = g + convex * p;
    const std::vector<Eigen::Index> movable = Movable(p, gradient, lower, upper);
    if (movable.empty()) break;
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(g.size());
    direction(movable) = -convex(movable, movable).ldlt().solve(gradient(movable));
    for (double step = 1; step > 1e-8; step /= 4) {
      const Eigen::VectorXd trial = (p + step * direction).cwiseMax(lower).cwiseMin(upper);
      const double trial_value = value(trial);
      if (trial_value < best - 1e-14 * std::abs(best)) {
        p = trial;
        best = trial_value;
        break;
      }
    }
    if (!(best < before - 1e-11 * std::abs(best))) break;
  }
  return p;
}

}  // namespace mortise::pareto
