// The result of discovery: the front as designs with their trade-offs, ready to be explored.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "services/pareto/archive.h"
#include "services/pareto/evaluation.h"
#include "services/pareto/patch_sampling.h"
#include "services/pareto/performance_buffer.h"

namespace mortise::pareto {

// A trade-off that nothing found beats. Every one has truly been evaluated.
struct FrontPoint {
  Eigen::VectorXd x;          // D, within the bounds
  Eigen::VectorXd metrics;    // d
  std::int64_t cell = 0;      // of the performance buffer
  int piece = 0;              // index of the continuous piece it belongs to
  Eigen::VectorXd embedding;  // d - 1 coordinates in [0, 1]: the angles of its ray over pi / 2
};

struct Front {
  std::vector<FrontPoint> points;  // by embedding (first coordinate, then second)
  int pieces = 0;
  Scaling scaling;  // of the buffer the cells refer to
};

// Takes the best candidate of each cell and drops the dominated ones (§7.5.5). Each point is
// labelled with the affine piece that explains most of the front among those that pass within
// `tolerance` of its design (greedily, largest piece first); points on no piece are joined to their
// neighbours along the front where the designs are within `joining` of each other, else they begin
// a piece of their own. Both distances are Euclidean in unit coordinates.
Front BuildFront(const DesignSpace& space, const Archive& archive, const PerformanceBuffer& buffer,
                 const std::vector<AffinePiece>& pieces, double tolerance = 0.02,
                 double joining = 0.15);

// The point nearest to a position of the embedding. INVALID_ARGUMENT (field "embedding") when it
// has not d - 1 coordinates in [0, 1]; FAILED_PRECONDITION when the front is empty.
absl::StatusOr<FrontPoint> PickAtEmbedding(const Front& front, const Eigen::VectorXd& position);

// The point whose metric `index` is nearest to `value`. INVALID_ARGUMENT (field "metric") for an
// unknown metric or a value that is not finite; FAILED_PRECONDITION when the front is empty.
absl::StatusOr<FrontPoint> PickAtMetric(const Front& front, Eigen::Index index, double value);

}  // namespace mortise::pareto
