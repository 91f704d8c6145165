// Answers questions that people ask of a discovered front while they drag a slider (§7.2, §7.6.2):
// which design is best here, what lies next to it, what an improvement costs, what remains if a
// metric must stay below a value.
//
// The front is in memory, and every question takes O(n) time for n points, some microseconds for a
// thousand. Answers are points that were evaluated, by their index; nothing is interpolated.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::pareto {

// The points of a front of d metrics and D parameters, a column each.
struct FrontPoints {
  Eigen::MatrixXd parameters;  // D x n, SI units
  Eigen::MatrixXd metrics;     // d x n, SI units
  Eigen::MatrixXd embedding;   // d - 1 x n, in [0, 1]; ascending where d = 2
  std::vector<int> piece;      // n
  Eigen::VectorXd signs;   // d: 1 for a metric that shall be small, -1 for one that shall be large
  Eigen::VectorXd ranges;  // D, SI units: how far parameters could be varied; 0: fixed
};

// What it takes to improve a metric by one SI unit, walking along the front where that metric
// improves the most for the distance walked (in metrics, each in units of its range along the
// front). It comes from a straight line, or a plane, through the neighbours, and so is good for
// small steps.
struct Improvement {
  Eigen::Index metric = 0;
  Eigen::VectorXd
      metrics;  // d, change of each; of the metric itself -1, or 1 where larger is better
  Eigen::VectorXd parameters;  // D, change of each
  // How much each parameter takes part, by the square of its change in units of its range: D, in
  // [0, 1], with sum 1 (all 0 where the design stays the same).
  Eigen::VectorXd shares;
};

// A limit that a metric or a parameter must meet.
struct FrontLimit {
  bool of_metric = true;   // else of a parameter
  Eigen::Index index = 0;  // of it
  std::optional<double> minimum;
  std::optional<double> maximum;
};

// Says how two metrics go together: the correlation of how good they are.
struct MetricConflict {
  Eigen::Index first = 0;
  Eigen::Index second = 0;
  double correlation =
      0;  // -1: one improves as much as the other worsens; 1: both improve together
};

// The part of a front that meets limits.
struct FrontPart {
  std::vector<int> points;           // ascending
  Eigen::VectorXd least_parameters;  // D; empty without points
  Eigen::VectorXd most_parameters;   // D
  Eigen::VectorXd least_metrics;     // d
  Eigen::VectorXd most_metrics;      // d
  int pieces = 0;                    // different ones
  std::vector<MetricConflict>
      conflicts;  // each pair of metrics that vary, with three points or more
};

class FrontExploration {
 public:
  explicit FrontExploration(FrontPoints points);

  // Returns the point nearest to a position of the embedding, by the angle between their rays.
  // INVALID_ARGUMENT (field "embedding") when it has not d - 1 coordinates in [0, 1];
  // FAILED_PRECONDITION when the front is empty.
  absl::StatusOr<int> AtEmbedding(const Eigen::VectorXd& position) const;

  // Returns the point whose metric `metric` is nearest to `value`. INVALID_ARGUMENT (field
  // "metric") for an unknown metric or a value that is not finite; FAILED_PRECONDITION when the
  // front is empty.
  absl::StatusOr<int> AtMetric(Eigen::Index metric, double value) const;

  // Returns the point itself. INVALID_ARGUMENT (field "index") when there is none of that index.
  absl::StatusOr<int> At(int point) const;

  // Returns the points next to one, ascending: before and after it for d = 2, for more those with
  // the nearest rays, six for d = 3 and two more for each further metric.
  std::vector<int> NeighboursOf(int point) const;

  // Goes up to `steps` times from a point to the neighbour that improves `metric` the most for the
  // distance; fewer times where no neighbour improves it. Returns the points visited after the
  // first.
  std::vector<int> Walk(int point, Eigen::Index metric, int steps) const;

  // Returns what improving costs at a point, for each metric that varies there and of which the
  // front has something better; none where the point is alone on its piece.
  std::vector<Improvement> ImprovementsAt(int point) const;

  // Returns the part that remains when all `limits`, whose indices exist, must be met.
  FrontPart Within(const std::vector<FrontLimit>& limits) const;

  int size() const { return static_cast<int>(points_.metrics.cols()); }
  const FrontPoints& points() const { return points_; }

 private:
  std::vector<int> NearestOnPiece(int point, int count) const;
  std::vector<MetricConflict> ConflictsAmong(const std::vector<int>& points) const;

  FrontPoints points_;
  Eigen::MatrixXd rays_;           // d x n, from the ideal
  Eigen::VectorXd metric_ranges_;  // d, along the front; 1 where nothing varies
  Eigen::MatrixXd scaled_;         // d x n, 0 is best and 1 worst along the front
};

}  // namespace mortise::pareto
