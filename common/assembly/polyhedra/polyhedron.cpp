#include "common/assembly/polyhedra/polyhedron.h"

#include <algorithm>
#include <random>

#include "common/assembly/polyhedra/linear_programme.h"
#include "common/assembly/polyhedra/nearest_point_search.h"
#include "common/assembly/polyhedra/polyhedron_factors.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

absl::Status Check(const Polyhedron& polyhedron, const Eigen::VectorXd& x) {
  const auto fits = [&](const Eigen::MatrixXd& rows, const Eigen::VectorXd& ends) {
    return rows.rows() == ends.size() && (rows.rows() == 0 || rows.cols() == x.size());
  };
  if (!fits(polyhedron.inequalities, polyhedron.bounds) ||
      !fits(polyhedron.equalities, polyhedron.values)) {
    return InvalidField("polyhedron", "its sizes do not agree");
  }
  const bool is_finite = polyhedron.inequalities.allFinite() && polyhedron.bounds.allFinite() &&
                         polyhedron.equalities.allFinite() && polyhedron.values.allFinite();
  if (!is_finite || !x.allFinite()) return InvalidField("polyhedron", "must be finite");
  const auto has_zero_row = [](const Eigen::MatrixXd& rows) {
    return rows.rows() > 0 && rows.rowwise().norm().minCoeff() == 0;
  };
  if (has_zero_row(polyhedron.inequalities) || has_zero_row(polyhedron.equalities)) {
    return InvalidField("polyhedron", "has a row of zeros");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Projection> ProjectOnto(const Polyhedron& polyhedron, const Eigen::VectorXd& x) {
  MORTISE_RETURN_IF_ERROR(Check(polyhedron, x));
  Projection projection;
  projection.point = x;
  for (const PolyhedronFactor& factor : FactorsOf(polyhedron)) {
    if (factor.inequalities.empty() && factor.equalities.empty()) continue;
    MORTISE_ASSIGN_OR_RETURN(
        const Projection part,
        NearestPointSearch(PolyhedronOf(polyhedron, factor)).NearestTo(EntriesOf(x, factor)));
    if (!part.point) projection = Projection{};
    for (const int row : part.inequalities) {
      projection.inequalities.push_back(factor.inequalities[static_cast<std::size_t>(row)]);
    }
    for (const int row : part.equalities) {
      projection.equalities.push_back(factor.equalities[static_cast<std::size_t>(row)]);
    }
    if (!part.point) return projection;
    SetEntries(*part.point, factor, *projection.point);
  }
  std::sort(projection.inequalities.begin(), projection.inequalities.end());
  std::sort(projection.equalities.begin(), projection.equalities.end());
  return projection;
}

absl::StatusOr<Furthest> FurthestAlong(const Polyhedron& polyhedron,
                                       const Eigen::VectorXd& direction,
                                       const Eigen::VectorXd& from) {
  return FurthestBy([&](const Eigen::VectorXd& x) { return ProjectOnto(polyhedron, x); }, direction,
                    from);
}

// Of the cone of such directions, what lies in a box about 0: it has a corner other than 0 unless
// it is 0 alone, and what grows along neither a random direction nor against it is 0.
absl::StatusOr<std::optional<Eigen::VectorXd>> UnboundedDirection(
    const Eigen::MatrixXd& inequalities) {
  if (inequalities.cols() == 0) return std::optional<Eigen::VectorXd>();
  MORTISE_ASSIGN_OR_RETURN(
      LinearProgramme cone,
      LinearProgramme::Create(inequalities, Eigen::VectorXd::Zero(inequalities.rows()), 1));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Eigen::VectorXd direction(inequalities.cols());
  for (double& component : direction) component = normal(random);
  for (const double sign : {1.0, -1.0}) {
    MORTISE_ASSIGN_OR_RETURN(const auto corner, cone.Furthest(sign * direction));
    // A corner is 0 but for rounding, or reaches the box.
    if (corner && corner->lpNorm<Eigen::Infinity>() > 0.5) {
      return std::optional<Eigen::VectorXd>(corner->normalized());
    }
  }
  return std::optional<Eigen::VectorXd>();
}

}  // namespace mortise::parametric
