// Interpolates vectors given at scattered points by cubic radial basis functions:
//
//   f(x) = Σ_i w_i ‖x - x_i‖³ + p(x),
//
// p a polynomial, the w_i orthogonal to all such polynomials (Duchon 1977). Of all that
// interpolates it bends least; it needs no length to be chosen. Values with noise it need not meet:
// with λ > 0 it is what bends less and misses each value by λ w_i (Wahba 1990).
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace mortise::retrieval {

class RadialInterpolant {
 public:
  // `points` K × n, `values` D × n, the points of about unit extent along each axis. The polynomial
  // is quadratic where there are three points for each of its terms, otherwise linear.
  // INVALID_ARGUMENT if sizes disagree; FAILED_PRECONDITION, TOO_FEW_POINTS, if there are fewer
  // than two for each term, or they lie so that they do not determine it. O(n³ + n² D).
  // `smoothing` is λ, in cubed units of the points.
  static absl::StatusOr<RadialInterpolant> Fit(Eigen::MatrixXd points,
                                               const Eigen::MatrixXd& values, double smoothing = 0);

  // f(x), D. O(n (K + D)).
  Eigen::VectorXd At(const Eigen::VectorXd& x) const;

  // Returns how far f would be off at each point if it did not know its value (n), by the diagonal
  // of the inverse (Rippa 1999).
  const Eigen::VectorXd& left_out_errors() const { return left_out_errors_; }

 private:
  RadialInterpolant() = default;

  Eigen::MatrixXd points_;        // K × n
  Eigen::MatrixXd coefficients_;  // D × (n + terms)
  Eigen::Index terms_ = 0;
  Eigen::VectorXd left_out_errors_;
};

}  // namespace mortise::retrieval
