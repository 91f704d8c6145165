// Finds nearest points of polyhedra: convex quadratic programmes whose objective is a distance.
//
// The method is the dual active-set method of Goldfarb and Idnani (1983) with the identity as
// Hessian. It starts at the point itself and takes up one violated constraint after the other, so
// it needs no feasible start, ends after finitely many steps at the exact active set, and knows
// which constraints conflict when there is no point. An interior-point solver gives none of this,
// and is slower on the few dozen variables that designs have.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::parametric {

// The points x with inequalities · x <= bounds and equalities · x = values.
struct Polyhedron {
  Eigen::MatrixXd inequalities;  // m × n, no row zero
  Eigen::VectorXd bounds;        // m
  Eigen::MatrixXd equalities;    // k × n, no row zero
  Eigen::VectorXd values;        // k
};

struct Projection {
  // The point of the polyhedron nearest to the given one; nothing if the polyhedron is empty.
  std::optional<Eigen::VectorXd> point;
  // The rows that hold with equality and push there: point - x = -inequalitiesᵀ · y - equalitiesᵀ ·
  // w with y >= 0. In an empty polyhedron they are rows that cannot hold together, none of them
  // superfluous.
  std::vector<int> inequalities;
  std::vector<int> equalities;
};

// Finds the point of the polyhedron nearest to x. Constraints hold to 1e-10 of a unit row's
// distance. INVALID_ARGUMENT if sizes disagree or numbers are not finite; INTERNAL if rounding
// keeps the method from ending. It takes O((m + k) n) for each constraint that is taken up or let
// go, most often the k that are active in the end, in each factor (polyhedron_factors.h) by itself;
// an empty polyhedron tells of its first empty factor.
absl::StatusOr<Projection> ProjectOnto(const Polyhedron& polyhedron, const Eigen::VectorXd& x);

// The furthest point of a polyhedron along a direction.
struct Furthest {
  // The furthest point; nothing if there is none, because the polyhedron is empty or goes on
  // without end.
  std::optional<Eigen::VectorXd> point;
  // The rows of an empty polyhedron that cannot hold together, as in Projection.
  std::vector<int> inequalities;
  std::vector<int> equalities;
};

// Returns the point with the largest direction · x: the linear programme, by the proximal point
// method, whose steps are projections and which ends after finitely many (Ferris 1991). It begins
// at `from`, and of several furthest points it finds one near that. Fails as ProjectOnto does.
absl::StatusOr<Furthest> FurthestAlong(const Polyhedron& polyhedron,
                                       const Eigen::VectorXd& direction,
                                       const Eigen::VectorXd& from);

// Returns a unit direction in which inequalities · x <= bounds can be followed without end,
// whatever the bounds; nothing if there is none. It takes two linear programmes over the cone of
// such directions.
absl::StatusOr<std::optional<Eigen::VectorXd>> UnboundedDirection(
    const Eigen::MatrixXd& inequalities);

}  // namespace mortise::parametric
