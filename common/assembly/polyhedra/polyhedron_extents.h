// Finds how far a polyhedron goes along each of many directions, to and fro: its support function
// there.
//
// Most sizes of a design can become as large and as small as their own limit allows, whatever the
// others do. One corner of the polyhedron that touches many limits at once settles them all, so
// that few directions need a linear programme of their own (the filtering of bounds that Gleixner,
// Berthold, Müller and Weltge 2017 describe).
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace mortise::parametric {

struct Extents {
  Eigen::VectorXd least, greatest;  // of direction · x, by direction; infinite where without end
};

// Returns the extents of inequalities · x <= bounds, which must have a point, along each row of
// `directions`. Where a limit parallel to a direction is reached to 1e-9 of a unit row's distance,
// they are its bound to the last digit. INVALID_ARGUMENT if sizes disagree, numbers are not finite
// or a row is zero; else fails as LinearProgramme::Furthest.
//
// It takes at most one linear programme for each end of a direction, where parallel directions
// count once: about as many as there are limits that keep each other from being reached together.
absl::StatusOr<Extents> ExtentsAlong(const Eigen::MatrixXd& inequalities,
                                     const Eigen::VectorXd& bounds,
                                     const Eigen::MatrixXd& directions);

}  // namespace mortise::parametric
