// Takes the rounding of an ill-conditioned system out of its solution.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "absl/status/statusor.h"

namespace mortise::simulator {

// On 3 × nodes vectors that are zero where displacements are prescribed.
struct CorrectedSystem {
  std::function<Eigen::Matrix3Xd(const Eigen::Matrix3Xd&)> multiply;  // A x, as exactly as can be
  std::function<absl::StatusOr<Eigen::Matrix3Xd>(const Eigen::Matrix3Xd&)> solve;  // about A⁻¹ b
};

// Says how near the solution of A x = load is.
struct Correction {
  double error = 0;  // estimate, in the norm of energy √(xᵀ A x), relative
  int rounds = 0;
};

// Improves x, which is about right, by conjugate gradients on A that the approximate solution
// preconditions, until the error is below `tolerance` or rounding lets it fall no further: even
// where conditions of 1e14 leave but two digits of an approximate solution, a few rounds are
// enough. Fails as `solve` does; FAILED_PRECONDITION, reason SINGULAR, if A is not positive.
absl::StatusOr<Correction> CorrectSolution(const CorrectedSystem& system,
                                           const Eigen::Matrix3Xd& load, double tolerance,
                                           Eigen::Matrix3Xd& x);

}  // namespace mortise::simulator
