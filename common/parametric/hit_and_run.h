// Points spread evenly over a polyhedron, by hit-and-run (Smith 1984): from a point along a random
// line to anywhere inside, again and again.
//
// In a long and thin polyhedron most lines leave at once, and the walk would need millions of steps
// to get to the other end. So it is made round first: directions are drawn from the covariance of
// its furthest points, then of a walk through it (as Lovász and Vempala 2006 do to compute
// volumes). One that is flat, because its inequalities imply equalities, is walked within its
// plane.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::parametric {

// `count` points of inequalities · x <= bounds, which must be bounded and contain `start`. A seed
// gives the same points always. FAILED_PRECONDITION, POLYHEDRON_UNBOUNDED. O(count · n · (m n)) for
// m inequalities of n variables.
absl::StatusOr<std::vector<Eigen::VectorXd>> SamplePolyhedron(const Eigen::MatrixXd& inequalities,
                                                              const Eigen::VectorXd& bounds,
                                                              const Eigen::VectorXd& start,
                                                              int count, std::uint64_t seed);

}  // namespace mortise::parametric
