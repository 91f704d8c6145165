// Spreads points evenly over a polyhedron, by hit-and-run along coordinate directions (Smith 1984):
// from a point along a line to anywhere inside, again and again.
//
// In a long and thin polyhedron most lines leave at once, and the walk would need millions of steps
// to get to the other end. So it is made round first: directions are the principal axes of its
// furthest points, then of a walk through it (as Lovász and Vempala 2006 do to compute volumes).
// One that is flat, because its inequalities imply equalities, is walked within its plane. Factors
// (polyhedron_factors.h) are walked one by one: together they are as even as each.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::parametric {

// Returns `count` points of inequalities · x <= bounds, which must be bounded and have a point. A
// seed gives the same points always. FAILED_PRECONDITION with POLYHEDRON_UNBOUNDED or
// POLYHEDRON_EMPTY. It takes O(n² m) once and for each point, for m inequalities of n variables in
// the largest factor.
absl::StatusOr<std::vector<Eigen::VectorXd>> SamplePolyhedron(const Eigen::MatrixXd& inequalities,
                                                              const Eigen::VectorXd& bounds,
                                                              int count, std::uint64_t seed);

}  // namespace mortise::parametric
