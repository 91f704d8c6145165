#include "common/assembly/connections/connection_placement.h"

#include <Eigen/QR>
#include <algorithm>
#include <utility>

#include "common/assembly/model/linear_design.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr double kRankThreshold = 1e-9;  // of rows of an orthonormal basis
constexpr double kNoChange = 1e-9;       // length of a row along which nothing is free

std::size_t SoftCount(const std::vector<ElementConnection>& connections) {
  std::size_t count = 0;
  for (const ElementConnection& connection : connections) count += connection.soft.size();
  return count;
}

}  // namespace

ConnectionPlacement::ConnectionPlacement(const FeasibleSet& feasible_set,
                                         const std::vector<Element>& elements,
                                         std::vector<ElementConnection> connections)
    : connections_(std::move(connections)), elements_(static_cast<int>(elements.size())) {
  FindFree(feasible_set, elements);
  if (free_.cols() == 0) return;
  UseSoftMetric();
  for (const Relationship& relationship : feasible_set.inequalities()) {
    if (Along(relationship.form).norm() > kNoChange) inequalities_.push_back(relationship.form);
  }
  inequality_free_.resize(static_cast<Eigen::Index>(inequalities_.size()), free_.cols());
  for (std::size_t i = 0; i < inequalities_.size(); ++i) {
    inequality_free_.row(static_cast<Eigen::Index>(i)) = Along(inequalities_[i]).transpose();
  }
}

// The directions of the feasible set that leave alone what no soft relationship speaks of.
void ConnectionPlacement::FindFree(const FeasibleSet& feasible_set,
                                   const std::vector<Element>& elements) {
  std::vector<bool> is_placed(elements.size(), false);
  for (const ElementConnection& connection : connections_) {
    for (const int element : connection.connecting) {
      is_placed[static_cast<std::size_t>(element)] = true;
    }
  }
  const Eigen::MatrixXd& basis = feasible_set.basis();
  std::vector<Eigen::Index> still;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (int i = 0; !is_placed[e] && i < 6; ++i) {
      still.push_back(6 * static_cast<Eigen::Index>(e) + i);
    }
  }
  if (basis.cols() == 0 || still.size() == 6 * elements.size()) {
    free_.resize(basis.rows(), 0);
    return;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(kRankThreshold);
  qr.compute(basis(still, Eigen::all).transpose());
  const Eigen::Index degrees = basis.cols() - qr.rank();
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(basis.cols(), degrees);
  directions.bottomRows(degrees).setIdentity();
  directions.applyOnTheLeft(qr.householderQ());
  free_ = basis * directions;
  for (const Eigen::Index variable : still) free_.row(variable).setZero();  // not just nearly
}

void ConnectionPlacement::UseSoftMetric() {
  Eigen::MatrixXd soft(static_cast<Eigen::Index>(SoftCount(connections_)), free_.cols());
  Eigen::Index row = 0;
  for (const ElementConnection& connection : connections_) {
    for (const SoftRelationship& relationship : connection.soft) {
      soft.row(row).setZero();
      for (const LinearTerm& term : relationship.form.terms) {
        const int variable = DesignVariable(connection, term.variable);
        if (variable < 0) continue;
        soft.row(row) += relationship.weight * term.coefficient * free_.row(variable);
      }
      ++row;
    }
  }
  // Whatever is free moves a connecting element, and the soft rows of an element determine it.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(soft);
  const Eigen::Index degrees = free_.cols();
  soft_frame_ = qr.householderQ() * Eigen::MatrixXd::Identity(soft.rows(), degrees);
  const Eigen::MatrixXd triangle = qr.matrixQR().topRows(degrees);
  free_ = triangle.triangularView<Eigen::Upper>().solve<Eigen::OnTheRight>(free_);
}

int ConnectionPlacement::DesignVariable(const ElementConnection& connection, int variable) const {
  const int of_elements = 6 * static_cast<int>(connection.elements.size());
  if (variable >= connection.end_unknown()) return -1;
  if (variable >= of_elements) {
    const int offset = variable - of_elements;
    return 6 * elements_ + 3 * connection.joints[static_cast<std::size_t>(offset / 3)] + offset % 3;
  }
  const int element = variable / 6;
  const int principals = connection.principal_count();
  const int of_design = element < principals
                            ? connection.principals[static_cast<std::size_t>(element)]
                            : connection.connecting[static_cast<std::size_t>(element - principals)];
  return 6 * of_design + variable % 6;
}

Eigen::VectorXd ConnectionPlacement::Along(const LinearForm& form) const {
  Eigen::VectorXd along = Eigen::VectorXd::Zero(free_.cols());
  for (const LinearTerm& term : form.terms) {
    along += term.coefficient * free_.row(term.variable).transpose();
  }
  return along;
}

Eigen::VectorXd ConnectionPlacement::MissesAt(const Eigen::VectorXd& q) const {
  Eigen::VectorXd misses(soft_frame_.rows());
  Eigen::Index row = 0;
  for (const ElementConnection& connection : connections_) {
    if (connection.soft.empty()) continue;
    Eigen::VectorXd local(connection.parameter_count());
    for (int variable = 0; variable < connection.end_unknown(); ++variable) {
      local[variable] = q[DesignVariable(connection, variable)];
    }
    std::vector<BoundingBox> principals;
    for (int i = 0; i < connection.principal_count(); ++i) principals.push_back(BoxOf(local, i));
    for (int patch = 0; patch < static_cast<int>(connection.patches.size()); ++patch) {
      const BoundingBox region = PatchAt(connection, patch, principals).region;
      local.segment<3>(connection.PatchVariable(patch, Axis::kX)) = region.center();
      local.segment<3>(connection.PatchVariable(patch, Axis::kX) + 3) = region.size();
    }
    for (const SoftRelationship& relationship : connection.soft) {
      misses[row++] = relationship.weight * relationship.form.At(local);
    }
  }
  return misses;
}

absl::StatusOr<Eigen::VectorXd> ConnectionPlacement::Place(
    const Eigen::VectorXd& q, const std::vector<LinearForm>& held) const {
  if (free_.cols() == 0) return q;
  Polyhedron allowed;
  allowed.inequalities = inequality_free_;
  allowed.bounds.resize(inequality_free_.rows());
  for (std::size_t i = 0; i < inequalities_.size(); ++i) {
    // q is feasible; where it touches an end, rounding must not make it look otherwise.
    allowed.bounds[static_cast<Eigen::Index>(i)] = std::max(0.0, -inequalities_[i].At(q));
  }
  std::vector<Eigen::VectorXd> rows;
  for (const LinearForm& form : held) {
    Eigen::VectorXd along = Along(form);
    if (along.norm() > kNoChange) rows.push_back(std::move(along));
  }
  allowed.equalities.resize(static_cast<Eigen::Index>(rows.size()), free_.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    allowed.equalities.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  }
  allowed.values = Eigen::VectorXd::Zero(allowed.equalities.rows());
  MORTISE_ASSIGN_OR_RETURN(const Projection nearest,
                           ProjectOnto(allowed, -soft_frame_.transpose() * MissesAt(q)));
  if (!nearest.point) return absl::InternalError("a feasible design was lost");
  return Eigen::VectorXd(q + free_ * *nearest.point);
}

}  // namespace mortise::parametric
