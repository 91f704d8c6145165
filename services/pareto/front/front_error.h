// Measures how far designs are from the true front, by trying to push them further (Eq. 7.8).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "services/pareto/front/front.h"

namespace mortise::pareto {

// A design after a local optimisation from it, min |F(x) - (F(x_j) + delta_N d_N)| over the box,
// with d_N the normal of the front at F(x_j), towards the ideal, from the dual variables there.
struct PushedDesign {
  Eigen::VectorXd x;        // D
  Eigen::VectorXd metrics;  // d
  // The distance by which it has come nearer to the reference point, in scaled performance: its
  // distance from the front, or delta_N where that was more. (Along the front it may slide, which
  // is no error.) NaN where the design has no gradients.
  double error = 0;
};

// Pushes a design. `evaluate` gives metrics with their Jacobian; there are no constraints, and
// `step` of the space is ignored. It uses Newton's method within a trust region, with the Hessian
// by differences of gradients: 2 D evaluations an iteration, some five iterations near a smooth
// front.
PushedDesign PushAlongNormal(const DesignSpace& space, const Scaling& scaling,
                             const std::function<Evaluation(const Eigen::VectorXd& x)>& evaluate,
                             const Eigen::VectorXd& x, double delta_n = 1e-2);

// Returns the errors of a front's points, in their order.
std::vector<double> FrontErrors(const DesignSpace& space, const Front& front,
                                const std::function<Evaluation(const Eigen::VectorXd& x)>& evaluate,
                                double delta_n = 1e-2);

}  // namespace mortise::pareto
