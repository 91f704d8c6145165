// A local frame of the front: the points near one, as a line or plane in metrics and in parameters.
#include "services/pareto/front/front_exploration.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/pareto/archive/embedding.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kFitted = 6;              // points of a local frame, for each of its dimensions
constexpr double kFlat = 1e-6;          // of the largest singular value: no direction of the front
constexpr double kMinVariation = 1e-3;  // of a metric along the front, in scaled performance

absl::Status EmptyFront() {
  return PreconditionFailed("FRONT_EMPTY", "the front has no points: every evaluation failed");
}

int NearestColumn(const MatrixXd& columns, const VectorXd& place) {
  Index nearest = 0;
  (columns.colwise() - place).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

// The first `count` of the pairs in ascending order.
std::vector<int> FirstOf(std::vector<std::pair<double, int>> distances, int count) {
  const auto kept = std::min<std::ptrdiff_t>(count, std::ssize(distances));
  std::partial_sort(distances.begin(), distances.begin() + kept, distances.end());
  std::vector<int> first;
  for (std::ptrdiff_t i = 0; i < kept; ++i) first.push_back(distances[i].second);
  return first;
}

// The front near a point: moving by s along it changes scaled metrics by `metrics` s and parameters
// by `parameters` s.
struct LocalFrame {
  MatrixXd metrics;     // d x r, orthonormal
  MatrixXd parameters;  // D x r
};

// By total least squares in the metrics, ordinary ones in the parameters.
LocalFrame FitFrame(MatrixXd metrics, MatrixXd parameters) {
  metrics.colwise() -= metrics.rowwise().mean().eval();
  parameters.colwise() -= parameters.rowwise().mean().eval();
  const Eigen::JacobiSVD<MatrixXd> svd(metrics, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& sizes = svd.singularValues();
  Index rank = 0;
  while (rank < std::min<Index>(metrics.rows() - 1, sizes.size()) && sizes[rank] > 0 &&
         sizes[rank] > kFlat * sizes[0]) {
    ++rank;
  }
  LocalFrame frame;
  frame.metrics = svd.matrixU().leftCols(rank);
  frame.parameters =
      parameters * svd.matrixV().leftCols(rank) * sizes.head(rank).cwiseInverse().asDiagonal();
  return frame;
}

VectorXd SharesOf(const VectorXd& change, const VectorXd& ranges) {
  VectorXd shares = VectorXd::Zero(change.size());
  for (Index i = 0; i < change.size(); ++i) {
    if (ranges[i] > 0) shares[i] = std::pow(change[i] / ranges[i], 2);
  }
  const double sum = shares.sum();
  if (sum > 0) shares /= sum;
  return shares;
}

bool Meets(double value, const FrontLimit& limit) {
  return !(limit.minimum && value < *limit.minimum) && !(limit.maximum && value > *limit.maximum);
}

// The least and most of each row among some columns, at least one. Column by column, as they lie in
// memory: four times as fast as Eigen's row by row for 21 x 5,000.
void RangesOf(const MatrixXd& values, const std::vector<int>& columns, VectorXd& least,
              VectorXd& most) {
  least = most = values.col(columns.front());
  for (const int column : columns) {
    least = least.cwiseMin(values.col(column));
    most = most.cwiseMax(values.col(column));
  }
}

int DifferentOnes(std::vector<int> values) {
  std::ranges::sort(values);
  return static_cast<int>(std::ranges::unique(values).begin() - values.begin());
}

}  // namespace

FrontExploration::FrontExploration(FrontPoints points) : points_(std::move(points)) {
  if (size() == 0) return;
  rays_ = RaysAt(points_.embedding);
  scaled_ = points_.signs.asDiagonal() * points_.metrics;
  const VectorXd best = scaled_.rowwise().minCoeff(), worst = scaled_.rowwise().maxCoeff();
  metric_ranges_ = (worst.array() > best.array()).select(worst - best, 1.0);
  scaled_ = metric_ranges_.cwiseInverse().asDiagonal() * (scaled_.colwise() - best).eval();
}

absl::StatusOr<int> FrontExploration::AtEmbedding(const VectorXd& position) const {
  if (size() == 0) return EmptyFront();
  const Index needed = points_.embedding.rows();
  if (position.size() != needed) {
    return InvalidField("embedding",
                        absl::StrCat(needed, " coordinates are needed, not ", position.size()));
  }
  for (Index i = 0; i < needed; ++i) {
    if (!(position[i] >= 0 && position[i] <= 1)) {
      return InvalidField(absl::StrCat("embedding[", i, "]"), "must lie between 0 and 1");
    }
  }
  return NearestColumn(rays_, RaysAt(position));
}

absl::StatusOr<int> FrontExploration::AtMetric(Index metric, double value) const {
  if (size() == 0) return EmptyFront();
  if (metric < 0 || metric >= points_.metrics.rows()) {
    return InvalidField("metric.name", "the front has no such metric");
  }
  if (!std::isfinite(value)) return InvalidField("metric.value", "must be a finite number");
  return NearestColumn(points_.metrics.row(metric), VectorXd::Constant(1, value));
}

absl::StatusOr<int> FrontExploration::At(int point) const {
  if (size() == 0) return EmptyFront();
  if (point < 0 || point >= size()) {
    return InvalidField("index", absl::StrCat("the front has points 0 to ", size() - 1));
  }
  return point;
}

std::vector<int> FrontExploration::NeighboursOf(int point) const {
  std::vector<int> neighbours;
  if (points_.metrics.rows() == 2) {
    if (point > 0) neighbours.push_back(point - 1);
    if (point + 1 < size()) neighbours.push_back(point + 1);
    return neighbours;
  }
  const VectorXd here = rays_.col(point);
  std::vector<std::pair<double, int>> distances;
  for (int i = 0; i < size(); ++i) {
    if (i != point) distances.emplace_back((rays_.col(i) - here).squaredNorm(), i);
  }
  neighbours = FirstOf(std::move(distances), NeighboursOnFront(rays_.rows()));
  std::ranges::sort(neighbours);
  return neighbours;
}

std::vector<int> FrontExploration::Walk(int point, Index metric, int steps) const {
  std::vector<int> path;
  for (int step = 0; step < steps; ++step) {
    double most = 0;
    int next = -1;
    for (const int neighbour : NeighboursOf(point)) {
      const double gain = scaled_(metric, point) - scaled_(metric, neighbour);
      const double distance = (scaled_.col(point) - scaled_.col(neighbour)).norm();
      if (gain > 0 && gain / distance > most) {
        most = gain / distance;
        next = neighbour;
      }
    }
    if (next < 0) break;
    path.push_back(next);
    point = next;
  }
  return path;
}

std::vector<int> FrontExploration::NearestOnPiece(int point, int count) const {
  std::vector<std::pair<double, int>> distances;
  for (int i = 0; i < size(); ++i) {
    if (points_.piece[i] == points_.piece[point]) {
      distances.emplace_back((scaled_.col(i) - scaled_.col(point)).squaredNorm(), i);
    }
  }
  return FirstOf(std::move(distances), count);
}

std::vector<Improvement> FrontExploration::ImprovementsAt(int point) const {
  const Index d = scaled_.rows();
  const std::vector<int> fitted =
      NearestOnPiece(point, 1 + kFitted * static_cast<int>(std::max<Index>(d - 1, 1)));
  if (std::ssize(fitted) < d) return {};
  const LocalFrame frame =
      FitFrame(scaled_(Eigen::all, fitted), points_.parameters(Eigen::all, fitted));
  std::vector<Improvement> improvements;
  for (Index metric = 0; metric < d; ++metric) {
    // At its end a front goes no further, though its frame would.
    if (!(scaled_(metric, point) > 0)) continue;
    const VectorXd fastest = -frame.metrics.row(metric).transpose();
    const double gain = fastest.squaredNorm();  // of the metric, for walking by `fastest`
    if (!(std::sqrt(gain) > kMinVariation)) continue;
    const VectorXd walked = fastest / (gain * metric_ranges_[metric]);
    const VectorXd change = frame.metrics * walked;
    Improvement improvement;
    improvement.metric = metric;
    improvement.metrics = points_.signs.cwiseProduct(metric_ranges_).cwiseProduct(change);
    improvement.metrics[metric] = -points_.signs[metric];
    improvement.parameters = frame.parameters * walked;
    improvement.shares = SharesOf(improvement.parameters, points_.ranges);
    improvements.push_back(std::move(improvement));
  }
  return improvements;
}

std::vector<MetricConflict> FrontExploration::ConflictsAmong(const std::vector<int>& points) const {
  if (points.size() < 3) return {};
  MatrixXd values = scaled_(Eigen::all, points);
  values.colwise() -= values.rowwise().mean().eval();
  const VectorXd sizes = values.rowwise().norm();
  std::vector<MetricConflict> conflicts;
  for (Index a = 0; a < values.rows(); ++a) {
    for (Index b = a + 1; b < values.rows(); ++b) {
      if (!(std::min(sizes[a], sizes[b]) > 0)) continue;
      const double correlation = values.row(a).dot(values.row(b)) / (sizes[a] * sizes[b]);
      conflicts.push_back({a, b, std::clamp(correlation, -1.0, 1.0)});
    }
  }
  return conflicts;
}

FrontPart FrontExploration::Within(const std::vector<FrontLimit>& limits) const {
  FrontPart part;
  std::vector<int> pieces;
  for (int i = 0; i < size(); ++i) {
    const bool meets = std::ranges::all_of(limits, [&](const FrontLimit& limit) {
      const MatrixXd& values = limit.of_metric ? points_.metrics : points_.parameters;
      return Meets(values(limit.index, i), limit);
    });
    if (!meets) continue;
    part.points.push_back(i);
    pieces.push_back(points_.piece[i]);
  }
  if (part.points.empty()) return part;
  part.pieces = DifferentOnes(std::move(pieces));
  RangesOf(points_.parameters, part.points, part.least_parameters, part.most_parameters);
  RangesOf(points_.metrics, part.points, part.least_metrics, part.most_metrics);
  part.conflicts = ConflictsAmong(part.points);
  return part;
}

}  // namespace mortise::pareto
