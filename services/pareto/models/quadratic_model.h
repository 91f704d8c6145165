// Fits local quadratic models of the metrics to evaluations that have been paid for already.
//
// Around an evaluated design c write s = u - c and, for one metric, q(s) = f(c) + g.s + s.H s / 2.
// Of all q that agree with the evaluations f(c + s_k) of the chosen neighbours, take the one that
// changes least from what was believed before: minimise
//
//   R^2 |g - g0|^2 / a  +  R^4 |H|_F^2 / (4 b)  +  sum_k e_k^2 / n_k,   e_k = q(s_k) - f(c + s_k),
//
// with R the radius of interest, lengths of the archive (archive.h) for units, g0 a prior gradient,
// n_k a slack that grows with the sixth power of the neighbour's distance, the square of what third
// derivatives may do. This is Broyden's least-change secant condition for many secants at once,
// with the curvature they reveal (Powell's least-Frobenius-norm models). Its solution is a sum of
// kernels: with t = s/R,
//
//   q = f(c) + g0.s + sum_k w_k (a t.t_k + b (t.t_k)^2),
//
// and the weights w solve one small symmetric positive definite system, shared by all metrics.
//
// Where the evaluator offered the gradient of a metric at c, it is used as it is (a -> 0), and H is
// brought into agreement with the gradients of the neighbours (Powell's symmetric update).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/models/constrained_quadratic.h"

namespace mortise::pareto {

struct QuadraticModel {
  Eigen::VectorXd centre;                 // D, unit coordinates
  Eigen::VectorXd value;                  // d
  Eigen::MatrixXd jacobian;               // d x D, per unit coordinate
  std::vector<Eigen::MatrixXd> hessians;  // d of D x D
  bool exact_gradients = false;           // every row of the Jacobian came from the evaluator

  // Returns the model's metrics (d) at `u`.
  Eigen::VectorXd Predict(const Eigen::VectorXd& u) const;

  // Returns sum_i weights_i H_i.
  Eigen::MatrixXd WeightedHessian(const Eigen::VectorXd& weights) const;
};

// Fits a model around entry `centre` (evaluated) of the archive for the region |s| <= `radius`, in
// the lengths of the archive. `prior` (d x D; empty for zero) is the believed Jacobian.
QuadraticModel FitQuadraticModel(const Archive& archive, std::size_t centre, double radius,
                                 const Eigen::MatrixXd& prior);

// Fits a model of the constraints in the same way (m in the place of d).
QuadraticModel FitConstraintModel(const Archive& archive, std::size_t centre, double radius,
                                  const Eigen::MatrixXd& prior);

// Returns a model of constraints as functions of how far a design is from `u`, each in units of its
// size (`sizes`, m).
std::vector<QuadraticFunction> ConstraintsAround(const QuadraticModel& model,
                                                 const Eigen::VectorXd& u,
                                                 const Eigen::VectorXd& sizes);

// Returns the neighbours such a fit uses, nearest first: dense clusters and rows of samples are
// thinned so that those that remain look at `centre` from many sides and distances.
std::vector<std::size_t> SpreadNeighbours(const Archive& archive, std::size_t centre,
                                          std::size_t count);

}  // namespace mortise::pareto
