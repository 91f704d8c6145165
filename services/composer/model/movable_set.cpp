#include "services/composer/model/movable_set.h"

#include <cmath>
#include <utility>

#include "common/base/errors.h"

namespace mortise::composer {
namespace {

using parametric::FeasibleSet;
using parametric::LinearForm;
using parametric::ParametricAssembly;

constexpr double kNoChange = 1e-9;  // of a form, over the set
constexpr double kHeld = 1e-9;      // m; what such a form may miss

double DiagonalOf(const ParametricAssembly& assembly) {
  return parametric::AssemblyDiagonal(assembly.assembly());
}

Eigen::VectorXd ScalesOf(const ParametricAssembly& assembly) {
  return ChangeScales(assembly, DiagonalOf(assembly));
}

}  // namespace

MovableSet::MovableSet(const ParametricAssembly& assembly)
    : feasible_(*assembly.FreeInSpace().Rescaled(ScalesOf(assembly))),
      weights_(ScalesOf(assembly).cwiseAbs2().cwiseInverse()),
      moves_(DiagonalOf(assembly) * assembly.Translations()) {
  const auto& kept = feasible_.inequalities();
  inequalities_.resize(static_cast<Eigen::Index>(kept.size()), feasible_.basis().cols() + 3);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    inequalities_.row(static_cast<Eigen::Index>(i)) = RowOf(kept[i].form);
  }
}

Eigen::RowVectorXd MovableSet::RowOf(const LinearForm& form) const {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(feasible_.basis().cols() + 3);
  for (const parametric::LinearTerm& term : form.terms) {
    row.head(feasible_.basis().cols()) += term.coefficient * feasible_.basis().row(term.variable);
    row.tail<3>() += term.coefficient * moves_.row(term.variable);
  }
  return row;
}

absl::StatusOr<std::optional<MovableSet::Nearest>> MovableSet::NearestTo(
    const Eigen::VectorXd& wish, const std::vector<parametric::Demand>& demands) const {
  const Eigen::MatrixXd& basis = feasible_.basis();
  const Eigen::VectorXd there =
      feasible_.drawn() +
      basis * (basis.transpose() * weights_.cwiseProduct(wish - feasible_.drawn()));
  parametric::Polyhedron rows{inequalities_, Eigen::VectorXd(inequalities_.rows()),
                              Eigen::MatrixXd(0, inequalities_.cols()), Eigen::VectorXd(0)};
  for (Eigen::Index i = 0; i < rows.bounds.size(); ++i) {
    rows.bounds[i] = -feasible_.inequalities()[static_cast<std::size_t>(i)].form.At(there);
  }
  for (const parametric::Demand& demand : demands) {
    const Eigen::RowVectorXd row = RowOf(demand.form);
    const double missing = demand.value - demand.form.At(there);
    if (row.norm() <= kNoChange) {
      if (std::abs(missing) > kHeld) return std::optional<Nearest>();
      continue;
    }
    const Eigen::Index count = rows.equalities.rows() + 1;
    rows.equalities.conservativeResize(count, Eigen::NoChange);
    rows.equalities.bottomRows(1) = row;
    rows.values.conservativeResize(count);
    rows.values[count - 1] = missing;
  }
  MORTISE_ASSIGN_OR_RETURN(
      const parametric::Projection nearest,
      parametric::ProjectOnto(rows, Eigen::VectorXd::Zero(inequalities_.cols())));
  if (!nearest.point) return std::optional<Nearest>();
  const Eigen::VectorXd& point = *nearest.point;
  return std::optional<Nearest>(
      {there + basis * point.head(basis.cols()) + moves_ * point.tail<3>(), point.squaredNorm()});
}

}  // namespace mortise::composer
