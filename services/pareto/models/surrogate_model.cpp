#include "services/pareto/models/surrogate_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMinKnee = 1.25;      // above the reference of improvements
constexpr int kFirstEvaluations = 60;  // of the posterior density, for each start
constexpr int kEvaluations = 25;       // from where hyperparameters were
constexpr Index kFewPoints = 30;       // while there are so few, every one may change much

double MedianOf(VectorXd values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

MatrixXd PointsOf(const Archive& archive, const std::vector<std::size_t>& entries) {
  MatrixXd points(archive[entries.front()].u.size(), static_cast<Index>(entries.size()));
  for (std::size_t k = 0; k < entries.size(); ++k) {
    points.col(static_cast<Index>(k)) = archive[entries[k]].u;
  }
  return points;
}

// How much all metrics of an entry must improve, in scaled performance, until none dominates it.
double DistanceFromFront(const Archive& archive, const Scaling& scaling, std::size_t entry) {
  double distance = std::numeric_limits<double>::infinity();
  if (!archive[entry].evaluated) return distance;
  for (const std::size_t other : archive.non_dominated()) {
    const VectorXd worse =
        (archive[entry].metrics - archive[other].metrics).cwiseQuotient(scaling.range);
    distance = std::min(distance, worse.maxCoeff());
  }
  return distance;
}

// All entries, the nearest to the front first; those that violate constraints and those that failed
// after the others.
std::vector<std::size_t> NearestToFront(const Archive& archive, const Scaling& scaling) {
  std::vector<double> distances(archive.size());
  for (std::size_t entry = 0; entry < archive.size(); ++entry) {
    distances[entry] = DistanceFromFront(archive, scaling, entry);
  }
  std::vector<std::size_t> order(archive.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t entry) {
    return std::pair(!archive[entry].feasible, distances[entry]);
  });
  return order;
}

// At most `count` of them, evenly from first to last.
std::vector<Index> Spread(Index size, Index count) {
  std::vector<Index> chosen;
  for (Index k = 0; k < std::min(size, count); ++k) {
    chosen.push_back(size <= count ? k : k * size / count);
  }
  return chosen;
}

// log Phi(z) and its slope.
std::pair<double, double> LogCumulative(double z) {
  if (z < -30) return {-0.5 * z * z - std::log(-z * std::sqrt(2 * std::numbers::pi)), -z};
  const double cumulative = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
  return {std::log(cumulative), density / cumulative};
}

}  // namespace

VectorXd LearntMetrics::Of(const VectorXd& metrics) const {
  VectorXd learnt = scaling.Apply(metrics);
  for (Index i = 0; i < learnt.size(); ++i) {
    if (learnt[i] > knees[i]) learnt[i] = knees[i] * (1 + std::log(learnt[i] / knees[i]));
  }
  return learnt;
}

GaussianProcess SurrogateModel::Trained(const MatrixXd& points, const VectorXd& values,
                                        Kept& kept) const {
  const Index n = points.cols();
  if (kept.hyperparameters.size() == 0 || n > kept.points + (n > kFewPoints ? n / 10 : 0)) {
    const std::vector<Index> chosen = Spread(n, static_cast<Index>(options_.fitted));
    const bool first = kept.points < kFewPoints;
    kept.hyperparameters =
        GaussianProcess::Fit(points(Eigen::all, chosen), values(chosen),
                             first ? GaussianProcess::Hyperparameters() : kept.hyperparameters,
                             first ? kFirstEvaluations : kEvaluations);
    kept.points = n;
  }
  return {points, values, kept.hyperparameters};
}

void SurrogateModel::Learn(const Archive& archive) {
  learnt_.scaling = archive.CurrentScaling();
  std::vector<std::size_t> entries = NearestToFront(archive, learnt_.scaling);
  if (entries.size() > options_.points) entries.resize(options_.points);
  std::vector<std::size_t> evaluated;
  std::ranges::copy_if(entries, std::back_inserter(evaluated),
                       [&](std::size_t entry) { return archive[entry].evaluated; });
  metrics_.clear();
  limits_.clear();
  LearnMetrics(archive, evaluated);
  LearnConstraints(archive, evaluated);
  if (evaluated.size() < entries.size()) LearnFailures(archive, entries);
}

void SurrogateModel::LearnMetrics(const Archive& archive, const std::vector<std::size_t>& entries) {
  const Index d = learnt_.scaling.ideal.size();
  MatrixXd scaled(d, static_cast<Index>(entries.size()));
  for (std::size_t k = 0; k < entries.size(); ++k) {
    scaled.col(static_cast<Index>(k)) = learnt_.scaling.Apply(archive[entries[k]].metrics);
  }
  learnt_.knees.resize(d);
  for (Index i = 0; i < d; ++i) learnt_.knees[i] = std::max(kMinKnee, MedianOf(scaled.row(i)));
  kept_metrics_.resize(static_cast<std::size_t>(d));
  const MatrixXd points = PointsOf(archive, entries);
  MatrixXd values(d, points.cols());
  for (Index k = 0; k < points.cols(); ++k) {
    values.col(k) = learnt_.Of(archive[entries[static_cast<std::size_t>(k)]].metrics);
  }
  for (Index i = 0; i < d; ++i) {
    metrics_.push_back(
        Trained(points, values.row(i).transpose(), kept_metrics_[static_cast<std::size_t>(i)]));
  }
}

void SurrogateModel::LearnConstraints(const Archive& archive,
                                      const std::vector<std::size_t>& entries) {
  const Index m = archive[entries.front()].constraints.size();
  kept_constraints_.resize(static_cast<std::size_t>(m));
  const MatrixXd points = PointsOf(archive, entries);
  for (Index j = 0; j < m; ++j) {
    VectorXd values(points.cols());
    for (Index k = 0; k < points.cols(); ++k) {
      values[k] = archive[entries[static_cast<std::size_t>(k)]].constraints[j];
    }
    if (values.maxCoeff() <= 0) continue;
    const double median = MedianOf(values.cwiseAbs());
    const double size = median > 0 ? median : values.cwiseAbs().maxCoeff();
    values = (values / size).unaryExpr([](double value) { return std::asinh(value); });
    limits_.push_back(Trained(points, values, kept_constraints_[static_cast<std::size_t>(j)]));
  }
}

void SurrogateModel::LearnFailures(const Archive& archive,
                                   const std::vector<std::size_t>& entries) {
  VectorXd values(static_cast<Index>(entries.size()));
  for (std::size_t k = 0; k < entries.size(); ++k) {
    values[static_cast<Index>(k)] = archive[entries[k]].evaluated ? -1 : 1;
  }
  limits_.push_back(Trained(PointsOf(archive, entries), values, kept_failure_));
}

void SurrogateModel::Believe(const VectorXd& u) {
  for (GaussianProcess& metric : metrics_) metric.Add(u, metric.Predict(u).mean);
  for (GaussianProcess& limit : limits_) limit.Add(u, limit.Predict(u).mean);
}

SurrogateModel::Belief SurrogateModel::At(const VectorXd& u) const {
  Belief belief;
  for (const GaussianProcess& metric : metrics_) belief.metrics.push_back(metric.Predict(u));
  belief.log_feasibility_gradient = VectorXd::Zero(u.size());
  for (const GaussianProcess& limit : limits_) {
    const GaussianProcess::Prediction prediction = limit.Predict(u);
    const double z = -prediction.mean / prediction.deviation;
    const auto [value, slope] = LogCumulative(z);
    belief.log_feasibility += value;
    belief.log_feasibility_gradient -=
        slope / prediction.deviation *
        (prediction.mean_gradient + z * prediction.deviation_gradient);
  }
  return belief;
}

SurrogateModel::Beliefs SurrogateModel::AtAll(const MatrixXd& designs) const {
  Beliefs beliefs;
  for (const GaussianProcess& metric : metrics_) {
    beliefs.metrics.push_back(metric.PredictAll(designs));
  }
  beliefs.log_feasibilities = VectorXd::Zero(designs.cols());
  for (const GaussianProcess& limit : limits_) {
    const GaussianProcess::Predictions predictions = limit.PredictAll(designs);
    for (Index k = 0; k < designs.cols(); ++k) {
      beliefs.log_feasibilities[k] +=
          LogCumulative(-predictions.means[k] / predictions.deviations[k]).first;
    }
  }
  return beliefs;
}

VectorXd SurrogateModel::Noise() const {
  VectorXd noise(static_cast<Index>(metrics_.size()));
  for (Index i = 0; i < noise.size(); ++i) noise[i] = metrics_[static_cast<std::size_t>(i)].noise();
  return noise;
}

}  // namespace mortise::pareto
