// Finds steps of a local optimisation that has constraints: minimises quadratics within quadratics,
// over a box.
//
// The method is sequential quadratic programming (Kraft's SLSQP, of NLopt), which holds bounds
// exactly and needs no convexity.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::pareto {

// The function value + gradient.p + p.hessian p / 2, for p of n coordinates.
struct QuadraticFunction {
  double value = 0;
  Eigen::VectorXd gradient;  // n
  Eigen::MatrixXd hessian;   // n x n, symmetric

  double operator()(const Eigen::VectorXd& p) const {
    return value + gradient.dot(p) + 0.5 * p.dot(hessian * p);
  }
};

// Returns a local minimiser p of `objective` with lower <= p <= upper, lower <= 0 <= upper, and
// each of `constraints` <= 0. One that is above 0 at p = 0 must not get worse. The result keeps to
// all of this and is no worse than 0, which it is where nothing better was found.
Eigen::VectorXd MinimizeWithin(const QuadraticFunction& objective,
                               const std::vector<QuadraticFunction>& constraints,
                               const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

// Returns a p in the same box that brings down the sum of squares of what `constraints` are above
// 0, to 0 if that is possible; of several such about the shortest.
Eigen::VectorXd ReduceViolation(const std::vector<QuadraticFunction>& constraints,
                                const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

// Returns sqrt(sum_j max(0, constraints_j(p))^2).
double Violation(const std::vector<QuadraticFunction>& constraints, const Eigen::VectorXd& p);

}  // namespace mortise::pareto
