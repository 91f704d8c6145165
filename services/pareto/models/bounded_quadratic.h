// Finds the step of a bounded least-squares iteration: minimises a quadratic over a box.
#pragma once

#include <Eigen/Core>

namespace mortise::pareto {

// Returns a minimiser p of g.p + p.B p / 2 subject to lower <= p <= upper, where lower <= 0 <=
// upper and B (n x n) is symmetric. An indefinite B is first made positive semidefinite by dropping
// its negative eigenvalues, which leaves a step to the edge of the box along such directions.
//
// The method is projected Newton (Bertsekas 1982): variables at a bound whose gradient points
// outwards are held, the Newton step of the others is searched along its projection. Bounds hold
// exactly.
Eigen::VectorXd MinimizeBoundedQuadratic(const Eigen::VectorXd& g, const Eigen::MatrixXd& B,
                                         const Eigen::VectorXd& lower,
                                         const Eigen::VectorXd& upper);

}  // namespace mortise::pareto
