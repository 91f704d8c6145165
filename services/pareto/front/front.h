// The front is the result of discovery: designs with their trade-offs, ready to be explored.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/archive/performance_buffer.h"
#include "services/pareto/sources/patch_sampling.h"

namespace mortise::pareto {

// A trade-off. Every one has truly been evaluated.
struct FrontPoint {
  Eigen::VectorXd x;                 // D, within the bounds
  Eigen::VectorXd metrics;           // d
  Eigen::VectorXd constraints = {};  // m, all <= 0
  std::int64_t cell = 0;             // of the performance buffer
  int piece = 0;                     // index into Front::pieces
  Eigen::VectorXd embedding;  // d - 1 coordinates in [0, 1]: the angles of its ray over pi / 2
  // The distance by which it is further from the ideal than the best found in its cell, e_A of
  // §7.5.4: at most delta_B, in scaled performance.
  double approximation_error = 0;
  // The distance to the design of that neighbour along the front which is furthest away: Euclidean,
  // in unit coordinates. It is large where the design jumps though the performance does not.
  double jump = 0;
  std::size_t entry = 0;            // of the archive
  Eigen::VectorXd deviations = {};  // d, as Evaluation::deviations
};

// A continuous piece of the front: designs x = origin + directions t, t in units of the parameters'
// ranges.
struct FrontPiece {
  Eigen::VectorXd origin;      // D
  Eigen::MatrixXd directions;  // D x k, k <= d - 1; none where the points are on no affine subspace
  int points = 0;
};

struct Front {
  std::vector<FrontPoint> points;  // by embedding (first coordinate, then second)
  std::vector<FrontPiece> pieces;  // in the order in which they appear along the points
  Scaling scaling;                 // of the buffer the cells refer to
};

// Chooses for each place along the front (front_places.h) the candidate that makes for few and
// large pieces (front_labeling.h). Points on no piece are joined to their neighbours along the
// front where the designs are within `joining` of each other, Euclidean in unit coordinates, else
// they begin a piece of their own.
//
// Whatever the pieces are, the front reaches as far as what has been evaluated: for each metric its
// least and its greatest value are those of all feasible entries that none dominates, to the last
// bit. And no entry is better than a point by delta_B in every metric, or as good in each and
// better by 3 delta_B in one, in scaled performance.
Front BuildFront(const DesignSpace& space, const Archive& archive, const PerformanceBuffer& buffer,
                 const std::vector<AffinePiece>& pieces, double joining = 0.15);

}  // namespace mortise::pareto
