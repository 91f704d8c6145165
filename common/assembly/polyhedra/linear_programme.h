// Finds the furthest points of one polyhedron along one direction after the other, by the simplex
// method (Clp). Each programme begins at the corner where the last one ended. For the ends along
// many directions see polyhedron_extents.h, which needs few programmes.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>

#include "absl/status/statusor.h"

class ClpSimplex;

namespace mortise::parametric {

// A furthest point, and what holds it back.
struct ProgrammeCorner {
  Eigen::VectorXd point;
  // One an inequality, none negative: direction = inequalitiesᵀ · multipliers, so that by them no
  // point can lie further. They are 0 where an inequality does not hold with equality.
  Eigen::VectorXd multipliers;
};

class LinearProgramme {
 public:
  // Makes a programme over inequalities · x <= bounds, which must have a point, with no entry of x
  // further from 0 than `reach`. Without a reach, x may be anything where there are no rows.
  // INVALID_ARGUMENT if sizes disagree or numbers are not finite.
  static absl::StatusOr<LinearProgramme> Create(
      const Eigen::MatrixXd& inequalities, const Eigen::VectorXd& bounds,
      double reach = std::numeric_limits<double>::infinity());

  LinearProgramme(LinearProgramme&&) noexcept;
  LinearProgramme& operator=(LinearProgramme&&) noexcept;
  ~LinearProgramme();

  // Returns the point with the largest direction · x; nothing if the polyhedron goes on without
  // end. Of several such points it returns any, though the same one whenever the same programmes
  // are asked for in the same order. Constraints hold to 1e-9 of a unit row's distance.
  // FAILED_PRECONDITION, POLYHEDRON_EMPTY, if there is no point; INTERNAL if rounding keeps the
  // solver from ending.
  absl::StatusOr<std::optional<Eigen::VectorXd>> Furthest(const Eigen::VectorXd& direction);

  // The same with the inequalities' multipliers, for programmes without a reach.
  absl::StatusOr<std::optional<ProgrammeCorner>> FurthestCorner(const Eigen::VectorXd& direction);

 private:
  LinearProgramme(std::unique_ptr<ClpSimplex> solver, Eigen::VectorXd lengths);

  std::unique_ptr<ClpSimplex> solver_;
  Eigen::VectorXd lengths_;  // of the rows, which the solver has as unit rows
};

}  // namespace mortise::parametric
