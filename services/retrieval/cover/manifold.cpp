// Boxes, rays and extents of feasible sets.
#include "services/retrieval/cover/manifold.h"

#include <algorithm>
#include <limits>

#include "common/assembly/polyhedra/linear_programme.h"
#include "common/base/errors.h"
#include "services/retrieval/cover/differences.h"

namespace mortise::retrieval {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

LinearConstraints BoxConstraints(const VectorXd& lower, const VectorXd& upper) {
  const Index size = lower.size();
  LinearConstraints box;
  box.normals.resize(2 * size, size);
  box.normals << MatrixXd::Identity(size, size), -MatrixXd::Identity(size, size);
  box.bounds.resize(2 * size);
  box.bounds << upper, -lower;
  return box;
}

LinearConstraints BothConstraints(const LinearConstraints& a, const LinearConstraints& b) {
  LinearConstraints both;
  both.normals.resize(a.normals.rows() + b.normals.rows(), a.normals.cols());
  both.normals << a.normals, b.normals;
  both.bounds.resize(a.bounds.size() + b.bounds.size());
  both.bounds << a.bounds, b.bounds;
  return both;
}

double RoomAlong(const LinearConstraints& constraints, const VectorXd& q,
                 const VectorXd& direction) {
  const VectorXd rates = constraints.normals * direction;
  const VectorXd slacks = constraints.bounds - constraints.normals * q;
  double room = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < rates.size(); ++i) {
    if (rates[i] > 0) room = std::min(room, std::max(0.0, slacks[i]) / rates[i]);
  }
  return room;
}

absl::StatusOr<VectorXd> ExtentsOf(const LinearConstraints& constraints) {
  if (constraints.normals.cols() == 0) return VectorXd(0);
  MORTISE_ASSIGN_OR_RETURN(
      auto programme, parametric::LinearProgramme::Create(constraints.normals, constraints.bounds));
  const Index size = constraints.normals.cols();
  VectorXd extents(size);
  for (Index k = 0; k < size; ++k) {
    MORTISE_ASSIGN_OR_RETURN(const auto upper, programme.Furthest(VectorXd::Unit(size, k)));
    MORTISE_ASSIGN_OR_RETURN(const auto lower, programme.Furthest(-VectorXd::Unit(size, k)));
    if (!upper || !lower) {
      return PreconditionFailed("FEASIBLE_SET_UNBOUNDED",
                                "a parameter may grow without end, so the family has no cover");
    }
    extents[k] = std::max(0.0, (*upper)[k] - (*lower)[k]);
  }
  return extents;
}

int Manifold::Structure(const VectorXd&) const { return 0; }

absl::StatusOr<Derivatives> Manifold::DerivativesAt(const VectorXd& q) const {
  MORTISE_ASSIGN_OR_RETURN(const VectorXd extents, ExtentsOf(constraints()));
  MORTISE_ASSIGN_OR_RETURN(const VectorXd value, Evaluate(q));
  ParallelEvaluator evaluator(*this, 1);
  return CentralDifferences(evaluator, q, value, DifferenceSteps(extents, noise()));
}

}  // namespace mortise::retrieval
