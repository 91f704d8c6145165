// Expands the front to first order around a Pareto-critical design (§7.4, Proposition 3).
//
// At a critical design u* dual variables alpha >= 0 (sum 1) and beta >= 0 satisfy
//
//   sum_i alpha_i grad f_i + sum_k beta_k grad g_k = 0,
//
// where the active constraints g_k are the bounds that u* touches, and those of the problem. The
// gradient of a bound is plus or minus a unit vector, so on the free coordinates the condition
// reads J_F^T alpha = 0 (alpha spans the null space of the active Jacobian), and on the held ones
// beta is the inward slope of alpha.F, which must not be negative. With Z a basis of the moves of
// the free coordinates that no active constraint of the problem objects to at first order, Z^T
// J_F^T alpha = 0 takes its place, and mu >= 0 are the multipliers of those constraints. Along the
// front u(t), by (7.3) and (7.4),
//
//   u'_F = Z v,   Z^T H_FF Z v in Im(Z^T J_F^T),   u'_held = 0,
//   H = sum_i alpha_i H_i + sum_k mu_k H_gk
//
// (the Hessians of the bounds vanish), a space of d - 1 dimensions since alpha J_F Z = 0. Where H
// is singular the design can slide without ceasing to be critical; of those free directions the
// ones that move the performance most are taken, by damping H relative to its largest eigenvalue.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::pareto {

struct KktPoint {
  Eigen::VectorXd alpha;           // d, >= 0, sum 1
  Eigen::VectorXd beta;            // D, multipliers of held bounds (0 where free)
  std::vector<Eigen::Index> free;  // coordinates that may move, ascending
  Eigen::VectorXd mu;              // multipliers of the problem's constraints, >= 0
  Eigen::MatrixXd tangent;         // |free| x r, orthonormal: Z
  double residual = 1;             // |Z^T J_F^T alpha| / sum_i alpha_i |J_F,i|, in [0, 1]
};

// Recovers the duals at `u` (D, unit coordinates) from the scaled Jacobian (d x D). A bound counts
// as active within `bound_tolerance`, in parts of the parameter's range. Bounds whose multiplier
// would be negative are freed. At a corner with fewer than d - 1 free coordinates, those bounds are
// freed along which the metrics disagree most, since that is where the front goes on. `free` is
// empty where the metrics agree: a front of one point.
//
// `normals` (k x D) are the gradients of constraints that are met with nothing to spare; those
// whose multiplier would be negative are released, as are all where they leave no move at all.
KktPoint RecoverDuals(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& u,
                      const Eigen::MatrixXd& normals = {}, double bound_tolerance = 1e-6);

// Returns up to d - 1 orthonormal directions (columns, D rows) along which the front continues from
// `kkt`; `hessian` (D x D) is sum_i alpha_i H_i in scaled metrics, with sum_k mu_k H_gk.
Eigen::MatrixXd ExpansionDirections(const KktPoint& kkt, const Eigen::MatrixXd& jacobian,
                                    const Eigen::MatrixXd& hessian);

}  // namespace mortise::pareto
