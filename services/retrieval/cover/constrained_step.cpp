// The quadratic programme as a projection, by the Cholesky factor of its Hessian.
#include "services/retrieval/cover/constrained_step.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "common/assembly/polyhedra/polyhedron.h"
#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDamping = 1e-6;  // of the Hessian's largest diagonal entry
// How far within each constraint a step ends, in units of its row: more than the projection's
// rounding, so that designs are evaluated only where constraints hold.
constexpr double kInside = 1e-9;

}  // namespace

absl::StatusOr<VectorXd> ConstrainedStep(const LinearConstraints& constraints, const VectorXd& q,
                                         const MatrixXd& jacobian, const VectorXd& extents,
                                         const VectorXd& move) {
  const Index size = q.size();
  const MatrixXd scaled = jacobian * extents.asDiagonal();
  MatrixXd hessian = scaled.transpose() * scaled;
  const double largest = hessian.diagonal().maxCoeff();
  if (!(largest > 0)) return VectorXd(VectorXd::Zero(size));
  hessian.diagonal().array() += kDamping * largest;
  const Eigen::LLT<MatrixXd> factor(hessian);
  // With y = Lᵀ · change the objective is the distance from L⁻¹ Jᵀ · move.
  const VectorXd wish = factor.matrixL().solve(scaled.transpose() * move);
  const MatrixXd rows = constraints.normals * extents.asDiagonal();
  const MatrixXd turned = factor.matrixL().solve(rows.transpose()).transpose();
  const VectorXd margins = kInside * rows.rowwise().norm().cwiseMax(turned.rowwise().norm());
  const VectorXd slacks = (constraints.bounds - constraints.normals * q).cwiseMax(0) - margins;
  const parametric::Polyhedron feasible{turned, slacks, MatrixXd(0, size), VectorXd(0)};
  MORTISE_ASSIGN_OR_RETURN(const auto projection, parametric::ProjectOnto(feasible, wish));
  if (!projection.point) return VectorXd(VectorXd::Zero(size));
  const VectorXd change = extents.asDiagonal() * factor.matrixU().solve(*projection.point);
  return VectorXd(std::min(1.0, RoomAlong(constraints, q, change)) * change);
}

}  // namespace mortise::retrieval
