// Moves designs of trade-offs on to the affine subspace through another one.
//
// Along a piece of the front designs differ in few directions (§7.5.4): those in which they change
// with the metrics. In all others the best values are much the same for all of them. So where one
// trade-off has come nearer to the front than the others, its advantage can be had for all of them:
// they keep their positions along those directions, and take everything else from it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/archive.h"

namespace mortise::pareto {

// Says how the designs of the trade-offs change with their metrics: their linear regression, in
// unit coordinates, on all metrics but the last.
class FrontTrend {
 public:
  // Fits the regression to n trade-offs, n >= 2, of two metrics or more. O(n D d).
  FrontTrend(const Archive& archive, const Scaling& scaling);

  // Returns an orthonormal basis of the directions in which designs change (D x r, r < d), without
  // the parameters of which the regression explains no more than `share` of the variance.
  Eigen::MatrixXd Directions(double share) const;

 private:
  Eigen::MatrixXd slopes_;     // D x (d - 1)
  Eigen::VectorXd explained_;  // D, shares of the variance
};

// Returns `count` designs within the box. Each has the position of a trade-off, or every other time
// of a place on the line through two of them, and is otherwise as one of the quarter of trade-offs
// that was found latest. The trade-offs, and the share that makes a direction, are drawn for each
// design. There are none while there are fewer trade-offs than twice the metrics, or for a single
// metric.
std::vector<Eigen::VectorXd> AlignedDesigns(const Archive& archive, const Scaling& scaling,
                                            std::size_t count, Random& random);

}  // namespace mortise::pareto
