// First and second derivatives of a manifold along its parameters, by differences that stay within
// the feasible set.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold.h"
#include "services/retrieval/cover/parallel_evaluator.h"

namespace mortise::retrieval {

// Returns the step along each parameter (K): the fourth root of the noise, which balances its part
// in a second difference, noise / h², against the part h² that is left out; of the parameter's
// extent, and between a thousandth and a sixteenth of it.
Eigen::VectorXd DifferenceSteps(const Eigen::VectorXd& extents, double noise);

// Returns what noise adds to a first derivative, as a part of the largest one, each parameter
// counted in parts of its extent.
double DerivativeError(double noise);

// Returns the derivatives at q, where M is `value`. Two evaluations a parameter: to either side if
// there is room, both to one side (of second order in the first derivative, first order in the
// second) otherwise. Where there is room for neither, the step shrinks with it. A parameter of
// extent 0 has derivatives 0. The error of the first evaluation that fails.
absl::StatusOr<Derivatives> CentralDifferences(ParallelEvaluator& evaluator,
                                               const Eigen::VectorXd& q,
                                               const Eigen::VectorXd& value,
                                               const Eigen::VectorXd& steps);

}  // namespace mortise::retrieval
