// The tangent space at a point of a manifold, in its numerical rank, with axes that are told by
// what bounds them (thesis §4.4).
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold.h"

namespace mortise::retrieval {

// A straight way through the feasible set from the centre's parameters, which moves the descriptor
// along a direction of the tangent space.
struct Way {
  Eigen::VectorXd change;  // K: of q, as far as the boundary (4.5)
  double length = 0;       // of the descriptor's move, to first order: r_b
};

class TangentFrame {
 public:
  // At q, with the derivatives there. `extents` (K) are the widths of the feasible set. Directions
  // in which all of it moves the descriptor by less than delta / 10 do not count, nor those that
  // move it by less than twice `error` of the furthest (DerivativeError of differences.h), or a
  // millionth. O(N K² + m K r²) for m constraints.
  TangentFrame(const LinearConstraints& constraints, const Eigen::VectorXd& q,
               const Derivatives& derivatives, const Eigen::VectorXd& extents, double delta,
               double error = 0);

  // r: the numerical rank.
  Eigen::Index rank() const { return basis_.cols(); }

  // N × r, orthonormal: the axes, those with the largest predicted radii first.
  const Eigen::MatrixXd& basis() const { return basis_; }

  // r: min(r_b + r_δ, r_c) along each axis, from curvature and boundary, before anything is
  // measured. Never less than delta: what lies within it of the centre is tight anyhow.
  const Eigen::VectorXd& predicted_radii() const { return predicted_; }

  // r: √(2δ / κ) along each axis, from the part of the second derivatives normal to the tangent
  // space along the parameters alone, as the thesis takes them; infinite where it is flat.
  const Eigen::VectorXd& curvature_radii() const { return curvature_; }

  // Returns the change of q (K), within the constraints, that brings the descriptor's move nearest
  // to `move` (r, along the axes) to first order, where q has gone by `from` already and the
  // manifold's move is known to fall short by `move` (constrained_step.h).
  absl::StatusOr<Eigen::VectorXd> StepFrom(const Eigen::VectorXd& from,
                                           const Eigen::VectorXd& move) const;

  // Returns the furthest way along the direction `move` (r). Where the Jacobian has lost rank, what
  // moves nothing helps to stay within the constraints: a linear programme finds out how.
  absl::StatusOr<Way> WayAlong(const Eigen::VectorXd& move) const;

 private:
  void Orient(const Derivatives& derivatives, const Eigen::VectorXd& slacks, double delta);
  double CurvatureRadius(const Eigen::VectorXd& direction, double delta) const;

  const LinearConstraints& constraints_;
  Eigen::VectorXd q_, extents_;
  Eigen::MatrixXd basis_;    // N × r
  Eigen::MatrixXd changes_;  // K × r: the least change of q for a move along each axis
  Eigen::MatrixXd moves_;    // r × K: ∂M/∂q in the axes
  Eigen::MatrixXd idle_;     // K × (K - r): changes of q that move nothing
  Eigen::MatrixXd bends_;    // N × K: second derivatives, normal part
  Eigen::VectorXd predicted_, curvature_;
};

// Returns how many of the first axes pay: m with the largest ∏ max(1, radii[i] / delta) / (m + 1),
// 0 for a point; the smallest of several. For m of 0 or r alone this is (4.6); a radius below delta
// covers no more than a point does. `radii` are in descending order.
Eigen::Index AxesThatPay(const Eigen::VectorXd& radii, double delta);

}  // namespace mortise::retrieval
