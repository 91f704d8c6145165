// Checks what the pieces of a front promise between its points: evaluates their designs densely.
//
// A front says more than its points do. A piece is an affine subspace of design space, and every
// design of it between those of its points is claimed to be a trade-off as well. Evaluating many of
// these shows how far that is true, and how much of the true front is represented: by the
// hypervolume of what comes out, in which designs that turn out to be dominated count nothing.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "services/pareto/front/front.h"

namespace mortise::pareto {

struct PieceEvaluationOptions {
  double spacing = 2e-4;           // wanted distance of neighbours, scaled performance
  std::int64_t designs = 100'000;  // at most, of all pieces together
  double tolerance = 0.02;         // how far from its subspace a point may be to lie on it
};

struct PieceEvaluation {
  std::int64_t evaluations = 0;
  // The metrics of the front's points, and of the designs evaluated that meet all constraints, d
  // each.
  std::vector<Eigen::VectorXd> metrics;
};

// Evaluates, of each piece,
//   - with one direction: the subspace from the first of its points to the last, and beyond as far
//     as to their neighbours;
//   - with two: the subspace within the convex hull of its points, wider by their mean distance;
//   - where points are on no subspace: straight between designs that are neighbours along the front
//     (three metrics: the triangles between them).
// All that is cut where performance changes most, until neighbours are `spacing` apart or the
// designs used up, but for what is plainly dominated by the front's points. Designs are clamped to
// the box. Where `evaluate` fails or a constraint is not met, the design counts nothing. With n
// points and m designs O(n m), and O(n^2) where points are on no subspace.
PieceEvaluation EvaluatePieces(const DesignSpace& space, const Front& front,
                               const std::function<Evaluation(const Eigen::VectorXd& x)>& evaluate,
                               const PieceEvaluationOptions& options = {});

}  // namespace mortise::pareto
