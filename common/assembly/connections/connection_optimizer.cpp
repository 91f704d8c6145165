#include "common/assembly/connections/connection_optimizer.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/assembly/connections/connection_relationships.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr double kHeld = 1e-9;      // m; a relationship missed by no more holds
constexpr double kNoChange = 1e-9;  // length of a row along which nothing is free
constexpr double kNoShare = 1e-7;   // of a relationship in a conflict

}  // namespace

ConnectionOptimizer::ConnectionOptimizer(ElementConnection connection)
    : connection_(std::move(connection)), given_(DrawnParameters(connection_)) {
  given_
      .segment(connection_.first_unknown(), connection_.end_unknown() - connection_.first_unknown())
      .setZero();
  SplitHard();
  SolveEqualities();
  UseSoftMetric();
}

ConnectionOptimizer::Rows ConnectionOptimizer::RowsOf(const std::vector<int>& hard) const {
  const int first = connection_.first_unknown();
  const int unknowns = connection_.end_unknown() - first;
  Rows rows{hard, Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(hard.size()), unknowns)};
  for (std::size_t i = 0; i < hard.size(); ++i) {
    const Relationship& relationship = connection_.hard[static_cast<std::size_t>(hard[i])];
    for (const LinearTerm& term : relationship.form.terms) {
      const int column = term.variable - first;
      if (column < 0 || column >= unknowns) continue;
      rows.coefficients(static_cast<Eigen::Index>(i), column) = term.coefficient;
    }
  }
  return rows;
}

void ConnectionOptimizer::SplitHard() {
  std::vector<int> equalities;
  std::vector<int> inequalities;
  for (int i = 0; i < static_cast<int>(connection_.hard.size()); ++i) {
    const bool equality = connection_.hard[static_cast<std::size_t>(i)].equality;
    (equality ? equalities : inequalities).push_back(i);
  }
  const std::vector<bool> independent = IndependentRows(RowsOf(equalities).coefficients);
  std::vector<int> kept;
  std::vector<int> implied;
  for (std::size_t i = 0; i < equalities.size(); ++i) {
    (independent[i] ? kept : implied).push_back(equalities[i]);
  }
  equalities_ = RowsOf(kept);
  implied_ = RowsOf(implied);
  inequalities_ = RowsOf(inequalities);
}

void ConnectionOptimizer::SolveEqualities() {
  const Eigen::Index unknowns = connection_.end_unknown() - connection_.first_unknown();
  const Eigen::Index rank = equalities_.coefficients.rows();
  if (rank == 0) {
    solve_.resize(unknowns, 0);
    free_ = Eigen::MatrixXd::Identity(unknowns, unknowns);
    return;
  }
  // A⁺ = Q R⁻ᵀ of Aᵀ = Q R, and N what Q has beyond.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(equalities_.coefficients.transpose());
  const Eigen::MatrixXd frame = qr.householderQ() * Eigen::MatrixXd::Identity(unknowns, unknowns);
  const Eigen::MatrixXd triangle = qr.matrixQR().topRows(rank).triangularView<Eigen::Upper>();
  solve_ =
      triangle.triangularView<Eigen::Upper>().solve(frame.leftCols(rank).transpose()).transpose();
  free_ = frame.rightCols(unknowns - rank);
}

void ConnectionOptimizer::UseSoftMetric() {
  const int first = connection_.first_unknown();
  const int unknowns = connection_.end_unknown() - first;
  soft_ = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(connection_.soft.size()), unknowns);
  for (std::size_t i = 0; i < connection_.soft.size(); ++i) {
    for (const LinearTerm& term : connection_.soft[i].form.terms) {
      const int column = term.variable - first;
      if (column < 0 || column >= unknowns) continue;
      soft_(static_cast<Eigen::Index>(i), column) = connection_.soft[i].weight * term.coefficient;
    }
  }
  const Eigen::Index degrees = free_.cols();
  if (degrees > 0) {
    // The soft rows of an element determine it, so this has full rank.
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(soft_ * free_);
    soft_frame_ = qr.householderQ() * Eigen::MatrixXd::Identity(soft_.rows(), degrees);
    const Eigen::MatrixXd triangle = qr.matrixQR().topRows(degrees);
    free_ = triangle.triangularView<Eigen::Upper>().solve<Eigen::OnTheRight>(free_);
  } else {
    soft_frame_.resize(soft_.rows(), 0);
  }
  const Eigen::MatrixXd along = inequalities_.coefficients * free_;
  std::vector<int> bearing;
  std::vector<int> decided;
  for (Eigen::Index i = 0; i < along.rows(); ++i) {
    (along.row(i).norm() > kNoChange ? bearing : decided)
        .push_back(inequalities_.relationships[static_cast<std::size_t>(i)]);
  }
  inequalities_ = RowsOf(bearing);
  decided_ = RowsOf(decided);
  inequality_free_ = inequalities_.coefficients * free_;
}

absl::Status ConnectionOptimizer::CheckPrincipals(
    const std::vector<BoundingBox>& principals) const {
  if (principals.size() != connection_.principals.size()) {
    return InvalidField("principals",
                        absl::StrCat("must be ", connection_.principals.size(), " boxes"));
  }
  for (std::size_t i = 0; i < principals.size(); ++i) {
    const std::string field = absl::StrCat("principals[", i, "]");
    if (!principals[i].minimum.allFinite() || !principals[i].maximum.allFinite()) {
      return InvalidField(field, "must be finite");
    }
    if (principals[i].size().minCoeff() <= 0) {
      return InvalidField(field, "must have a positive size along each axis");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<ConnectionPatch>> ConnectionOptimizer::PatchesOf(
    const std::vector<BoundingBox>& principals) const {
  std::vector<ConnectionPatch> patches;
  for (std::size_t i = 0; i < connection_.patches.size(); ++i) {
    const ConnectionPatch& drawn = connection_.patches[i];
    ConnectionPatch patch = PatchAt(connection_, static_cast<int>(i), principals);
    const auto first = static_cast<std::size_t>(drawn.first);
    const auto second = static_cast<std::size_t>(drawn.second);
    const std::string names = absl::StrCat("'", connection_.elements[first].name, "' and '",
                                           connection_.elements[second].name, "'");
    if (patch.kind != drawn.kind) {
      return PreconditionFailed("CONNECTION_APART", absl::StrCat(names, " do not touch"));
    }
    const int axis = static_cast<int>(drawn.normal);
    // What reaches into each other, or meets in several planes, has no one side.
    const bool is_flat = drawn.region.size()[axis] <= connection_.tolerance;
    if (drawn.kind == PatchKind::kContact && is_flat) {
      if (patch.normal != drawn.normal) {
        return PreconditionFailed("CONNECTION_APART",
                                  absl::StrCat(names, " meet across ", AxisName(patch.normal),
                                               " instead of ", AxisName(drawn.normal)));
      }
      const double before = connection_.elements[second].box.center()[axis] -
                            connection_.elements[first].box.center()[axis];
      const double now = principals[second].center()[axis] - principals[first].center()[axis];
      if (before * now < 0) {
        return PreconditionFailed(
            "CONNECTION_APART",
            absl::StrCat(names, " have changed sides along ", AxisName(drawn.normal)));
      }
    }
    patches.push_back(std::move(patch));
  }
  return patches;
}

Eigen::VectorXd ConnectionOptimizer::ValuesAt(const Rows& rows, const Eigen::VectorXd& q) const {
  Eigen::VectorXd values(static_cast<Eigen::Index>(rows.relationships.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const int relationship = rows.relationships[static_cast<std::size_t>(i)];
    values[i] = connection_.hard[static_cast<std::size_t>(relationship)].form.At(q);
  }
  return values;
}

absl::StatusOr<OptimizedConnection> ConnectionOptimizer::Optimize(
    const std::vector<BoundingBox>& principals) const {
  MORTISE_RETURN_IF_ERROR(CheckPrincipals(principals));
  MORTISE_ASSIGN_OR_RETURN(std::vector<ConnectionPatch> patches, PatchesOf(principals));
  Eigen::VectorXd q = given_;
  for (std::size_t i = 0; i < principals.size(); ++i) {
    q.segment<3>(6 * static_cast<Eigen::Index>(i)) = principals[i].center();
    q.segment<3>(6 * static_cast<Eigen::Index>(i) + 3) = principals[i].size();
  }
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const int variable = connection_.PatchVariable(static_cast<int>(i), Axis::kX);
    q.segment<3>(variable) = patches[i].region.center();
    q.segment<3>(variable + 3) = patches[i].region.size();
  }
  Eigen::VectorXd unknowns = -solve_ * ValuesAt(equalities_, q);
  Eigen::VectorXd misses(soft_.rows());
  for (std::size_t i = 0; i < connection_.soft.size(); ++i) {
    const SoftRelationship& soft = connection_.soft[i];
    misses[static_cast<Eigen::Index>(i)] = soft.weight * soft.form.At(q);
  }
  misses += soft_ * unknowns;
  const auto first = connection_.first_unknown();
  q.segment(first, unknowns.size()) = unknowns;
  MORTISE_RETURN_IF_ERROR(CheckDecided(q));
  if (free_.cols() > 0) {
    const Polyhedron allowed{inequality_free_, -ValuesAt(inequalities_, q),
                             Eigen::MatrixXd(0, free_.cols()), Eigen::VectorXd(0)};
    MORTISE_ASSIGN_OR_RETURN(const Projection nearest,
                             ProjectOnto(allowed, -soft_frame_.transpose() * misses));
    if (!nearest.point) return ConflictOf(nearest.inequalities);
    q.segment(first, unknowns.size()) += free_ * *nearest.point;
  }
  return Finish(std::move(q), std::move(patches));
}

absl::Status ConnectionOptimizer::CheckDecided(const Eigen::VectorXd& q) const {
  const Eigen::VectorXd implied = ValuesAt(implied_, q);
  for (Eigen::Index i = 0; i < implied.size(); ++i) {
    if (std::abs(implied[i]) <= kHeld) continue;
    return Conflict(implied_.coefficients.row(i).transpose(),
                    {implied_.relationships[static_cast<std::size_t>(i)]});
  }
  const Eigen::VectorXd decided = ValuesAt(decided_, q);
  for (Eigen::Index i = 0; i < decided.size(); ++i) {
    if (decided[i] <= kHeld) continue;
    return Conflict(decided_.coefficients.row(i).transpose(),
                    {decided_.relationships[static_cast<std::size_t>(i)]});
  }
  return absl::OkStatus();
}

// By Farkas' lemma some positive combination of the inequalities is one of the equalities.
absl::Status ConnectionOptimizer::ConflictOf(const std::vector<int>& inequalities) const {
  Eigen::MatrixXd along(static_cast<Eigen::Index>(inequalities.size()), free_.cols());
  std::vector<int> relationships;
  for (Eigen::Index i = 0; i < along.rows(); ++i) {
    const int row = inequalities[static_cast<std::size_t>(i)];
    along.row(i) = inequality_free_.row(row);
    relationships.push_back(inequalities_.relationships[static_cast<std::size_t>(row)]);
  }
  Eigen::FullPivLU<Eigen::MatrixXd> decomposition(along.transpose());
  decomposition.setThreshold(kNoChange);
  const Eigen::VectorXd shares = decomposition.kernel().col(0);
  Eigen::VectorXd combination = Eigen::VectorXd::Zero(inequalities_.coefficients.cols());
  for (Eigen::Index i = 0; i < along.rows(); ++i) {
    combination +=
        shares[i] *
        inequalities_.coefficients.row(inequalities[static_cast<std::size_t>(i)]).transpose();
  }
  return Conflict(combination, std::move(relationships));
}

// The relationships, and the equalities that `combination` of the unknowns is made of.
absl::Status ConnectionOptimizer::Conflict(const Eigen::VectorXd& combination,
                                           std::vector<int> relationships) const {
  const Eigen::VectorXd shares = solve_.transpose() * combination;
  for (Eigen::Index i = 0; i < shares.size(); ++i) {
    if (std::abs(shares[i]) <= kNoShare * std::max(1.0, shares.cwiseAbs().maxCoeff())) continue;
    relationships.push_back(equalities_.relationships[static_cast<std::size_t>(i)]);
  }
  std::vector<std::string> names;
  for (const int relationship : relationships) {
    // What repeats together does so in place and in size, under one name.
    const std::string& name = connection_.hard[static_cast<std::size_t>(relationship)].description;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return PreconditionFailed(
      "CONNECTION_CONFLICT",
      absl::StrCat(connection_.name, ": cannot hold together: ", absl::StrJoin(names, "; ")));
}

OptimizedConnection ConnectionOptimizer::Finish(Eigen::VectorXd q,
                                                std::vector<ConnectionPatch> patches) const {
  OptimizedConnection made;
  made.patches = std::move(patches);
  for (const Relationship& hard : connection_.hard) {
    const double value = hard.form.At(q);
    made.hard_residual =
        std::max(made.hard_residual, hard.equality ? std::abs(value) : std::max(value, 0.0));
  }
  double squares = 0;
  for (const SoftRelationship& soft : connection_.soft) {
    squares += std::pow(soft.weight * soft.form.At(q), 2);
  }
  made.soft_residual = std::sqrt(squares);
  const int principals = connection_.principal_count();
  for (int element = principals; element < static_cast<int>(connection_.elements.size());
       ++element) {
    made.connecting.push_back(BoxOf(q, element));
  }
  for (PlacedPart& part : PlaceParts(connection_.assembly, connection_.elements, q)) {
    if (part.element >= principals) made.parts.push_back(std::move(part));
  }
  made.q = std::move(q);
  return made;
}

}  // namespace mortise::parametric
