#include "services/interpolator/optimization/map_optimization.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <type_traits>
#include <utility>

#include "common/base/random.h"

namespace mortise::interpolator {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMaxEvaluations = 300;     // of one start by one method
constexpr double kStepTolerance = 1e-7;  // of the box
constexpr double kPolishingStep = 0.02;  // of the box
constexpr double kKept = 1e-7;       // of a metric's range: a limit that is missed by less is kept
constexpr double kInside = 1e-8;     // of a metric's range: how far inside limits searches aim
constexpr double kSamePlace = 1e-3;  // of the box

using Optimizer = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)>;

// The problem in coordinates of the unit box of those parameters that are free, with an objective
// and limits of the order of one.
class ScaledProblem {
 public:
  ScaledProblem(const MapOptimization& problem, const MapFunction& map)
      : problem_(problem), map_(map) {
    for (Index k = 0; k < problem.lower.size(); ++k) {
      if (problem.upper(k) > problem.lower(k)) free_.push_back(k);
    }
  }

  Index dimension() const { return static_cast<Index>(free_.size()); }

  // What there is to know of one point.
  struct Point {
    VectorXd place;  // in the unit box
    VectorXd parameters;
    VectorXd metrics;
    double objective = 0;      // as the expression says
    VectorXd excesses;         // one a side of a limit: what it is above 0, unscaled
    VectorXd objective_slope;  // by the coordinates of the unit box
    MatrixXd excess_slopes;    // likewise, a row a side
  };

  VectorXd Parameters(const VectorXd& place) const {
    VectorXd parameters = problem_.lower;
    for (Index k = 0; k < dimension(); ++k) {
      const Index at = free_[static_cast<std::size_t>(k)];
      parameters(at) = std::lerp(problem_.lower(at), problem_.upper(at), place(k));
    }
    return parameters;
  }

  absl::StatusOr<Point> Evaluate(const VectorXd& place, bool gradients) const {
    Point point;
    point.place = place;
    point.parameters = Parameters(place);
    auto values = map_(point.parameters, gradients);
    if (!values.ok()) return values.status();
    point.metrics = std::move(values->metrics);
    VectorXd all(point.parameters.size() + point.metrics.size());
    all << point.parameters, point.metrics;
    if (gradients) {
      auto objective = problem_.objective.ValueAndGradient(all);
      if (!objective.ok()) return objective.status();
      point.objective = objective->value;
      AddSlopes(objective->gradient, values->gradients, point);
    } else {
      const auto objective = problem_.objective.Value(all);
      if (!objective.ok()) return objective.status();
      point.objective = *objective;
    }
    AddExcesses(point);
    return point;
  }

  // Sets the scale by how far the objective ranges between these points, or else by its slope at
  // the first.
  void SetScale(const std::vector<Point>& points) {
    const auto [least, most] = std::ranges::minmax_element(points, {}, &Point::objective);
    objective_range_ = most->objective - least->objective;
    if (objective_range_ > 0) return;
    const absl::StatusOr<Point> first = Evaluate(points.front().place, true);
    if (first.ok()) objective_range_ = first->objective_slope.norm();
    if (!(objective_range_ > 0)) objective_range_ = 1;
  }

  double ObjectiveScale() const { return (problem_.maximize ? -1.0 : 1.0) / objective_range_; }
  // The range of the metric that a side belongs to.
  double RangeOfSide(Index side) const {
    return problem_.ranges(sides_[static_cast<std::size_t>(side)].metric);
  }
  Index side_count() const { return static_cast<Index>(sides_.size()); }

  double Violation(const Point& point) const {
    double violation = 0;
    for (Index side = 0; side < side_count(); ++side) {
      violation = std::max(violation, point.excesses(side) / RangeOfSide(side));
    }
    return violation > kKept ? violation : 0.0;
  }

  // Whether the first is to be preferred.
  bool IsBetter(const Point& a, const Point& b) const {
    const double violation_a = Violation(a), violation_b = Violation(b);
    if (violation_a != violation_b) return violation_a < violation_b;
    return ObjectiveScale() * a.objective < ObjectiveScale() * b.objective;
  }

  void ListSides() {
    for (const MetricLimit& limit : problem_.limits) {
      if (limit.minimum) sides_.push_back({limit.metric, -1, *limit.minimum});
      if (limit.maximum) sides_.push_back({limit.metric, 1, *limit.maximum});
    }
  }

 private:
  struct Side {
    Index metric = 0;
    double sign = 1;  // of the metric in what must not be above 0
    double bound = 0;
  };

  void AddExcesses(Point& point) const {
    point.excesses.resize(side_count());
    for (Index side = 0; side < side_count(); ++side) {
      const Side& of = sides_[static_cast<std::size_t>(side)];
      point.excesses(side) = of.sign * (point.metrics(of.metric) - of.bound);
    }
  }

  void AddSlopes(const VectorXd& of_objective, const MatrixXd& of_metrics, Point& point) const {
    const Index n = point.parameters.size();
    const VectorXd whole =
        of_objective.head(n) + of_metrics.transpose() * of_objective.tail(of_metrics.rows());
    point.objective_slope.resize(dimension());
    point.excess_slopes.resize(side_count(), dimension());
    for (Index k = 0; k < dimension(); ++k) {
      const Index at = free_[static_cast<std::size_t>(k)];
      const double length = problem_.upper(at) - problem_.lower(at);
      point.objective_slope(k) = whole(at) * length;
      for (Index side = 0; side < side_count(); ++side) {
        const Side& of = sides_[static_cast<std::size_t>(side)];
        point.excess_slopes(side, k) = of.sign * of_metrics(of.metric, at) * length;
      }
    }
  }

  const MapOptimization& problem_;
  const MapFunction& map_;
  std::vector<Index> free_;
  std::vector<Side> sides_;
  double objective_range_ = 1;
};

// One search from one start. The best point it has seen is its result, wherever it ends.
class Search {
 public:
  Search(const ScaledProblem& problem, ScaledProblem::Point start)
      : problem_(problem), best_(std::move(start)) {}

  const ScaledProblem::Point& best() const { return best_; }
  const absl::Status& fault() const { return fault_; }

  void Run(nlopt_algorithm algorithm) {
    const auto n = static_cast<unsigned>(problem_.dimension());
    const Optimizer optimizer(nlopt_create(algorithm, n), &nlopt_destroy);
    optimizer_ = optimizer.get();
    nlopt_set_min_objective(optimizer_, &Search::Objective, this);
    nlopt_set_lower_bounds1(optimizer_, 0);
    nlopt_set_upper_bounds1(optimizer_, 1);
    nlopt_set_xtol_rel(optimizer_, kStepTolerance);
    nlopt_set_maxeval(optimizer_, kMaxEvaluations);
    nlopt_set_initial_step1(optimizer_, kPolishingStep);
    const auto sides = static_cast<unsigned>(problem_.side_count());
    const std::vector<double> slack(sides, kInside / 2);
    if (sides > 0) {
      nlopt_add_inequality_mconstraint(optimizer_, sides, &Search::Excesses, this, slack.data());
    }
    VectorXd place = best_.place;
    double value = 0;
    nlopt_optimize(optimizer_, place.data(), &value);
    optimizer_ = nullptr;
  }

 private:
  // The point at a place: the last one if it is asked for again, as objective and limits do.
  const ScaledProblem::Point* At(unsigned n, const double* place, bool gradients) {
    const VectorXd at = VectorXd::Map(place, static_cast<Index>(n)).cwiseMax(0.0).cwiseMin(1.0);
    if (last_ && last_->place == at && (!gradients || last_->objective_slope.size() == at.size())) {
      return &*last_;
    }
    auto point = problem_.Evaluate(at, gradients);
    if (!point.ok()) {
      if (!IsOfThePoint(point.status())) fault_ = point.status();
      nlopt_force_stop(optimizer_);
      return nullptr;
    }
    last_ = *std::move(point);
    if (problem_.IsBetter(*last_, best_)) best_ = *last_;
    return &*last_;
  }

  static bool IsOfThePoint(const absl::Status& status) {
    return absl::IsOutOfRange(status) || absl::IsInvalidArgument(status);
  }

  static double Objective(unsigned n, const double* place, double* gradient, void* search) {
    auto& self = *static_cast<Search*>(search);
    const ScaledProblem::Point* point = self.At(n, place, gradient != nullptr);
    if (point == nullptr) return 0;
    const double scale = self.problem_.ObjectiveScale();
    if (gradient != nullptr) {
      VectorXd::Map(gradient, static_cast<Index>(n)) = scale * point->objective_slope;
    }
    return scale * point->objective;
  }

  static void Excesses(unsigned sides, double* result, unsigned n, const double* place,
                       double* gradient, void* search) {
    auto& self = *static_cast<Search*>(search);
    std::fill_n(result, sides, 0.0);
    const ScaledProblem::Point* point = self.At(n, place, gradient != nullptr);
    if (point == nullptr) return;
    for (unsigned side = 0; side < sides; ++side) {
      const double range = self.problem_.RangeOfSide(side);
      result[side] = point->excesses(side) / range + kInside;
      if (gradient == nullptr) continue;
      VectorXd::Map(gradient + std::size_t{side} * n, static_cast<Index>(n)) =
          point->excess_slopes.row(side).transpose() / range;
    }
  }

  const ScaledProblem& problem_;
  ScaledProblem::Point best_;
  std::optional<ScaledProblem::Point> last_;
  nlopt_opt optimizer_ = nullptr;  // while one runs
  absl::Status fault_;
};

// Spreads the starts over the box: its middle, then one in each slice of every coordinate.
std::vector<VectorXd> StartPlaces(Index dimension, int count, std::uint64_t seed) {
  std::vector<VectorXd> places{VectorXd::Constant(dimension, 0.5)};
  const auto others = static_cast<std::size_t>(count - 1);
  places.resize(1 + others, VectorXd(dimension));
  Random random(seed);
  std::vector<std::size_t> slices(others);
  for (Index k = 0; k < dimension; ++k) {
    std::iota(slices.begin(), slices.end(), std::size_t{0});
    for (std::size_t i = others; i > 1; --i) std::swap(slices[i - 1], slices[random.Index(i)]);
    for (std::size_t i = 0; i < others; ++i) {
      places[1 + i](k) =
          (static_cast<double>(slices[i]) + random.Uniform()) / static_cast<double>(others);
    }
  }
  return places;
}

absl::Status CheckProblem(const MapOptimization& problem) {
  if (problem.lower.size() != problem.upper.size() || !problem.lower.allFinite() ||
      !problem.upper.allFinite() || (problem.lower.array() > problem.upper.array()).any()) {
    return absl::InvalidArgumentError("the bounds must be finite, the lower below the upper");
  }
  if (!problem.ranges.allFinite() || !(problem.ranges.array() > 0).all()) {
    return absl::InvalidArgumentError("the ranges of metrics must be above 0");
  }
  if (problem.starts < 1) return absl::InvalidArgumentError("there must be at least one start");
  return absl::OkStatus();
}

// Evaluates the starts; those where there is nothing are left out.
absl::StatusOr<std::vector<ScaledProblem::Point>> EvaluateStarts(const ScaledProblem& scaled,
                                                                 const MapOptimization& problem) {
  std::vector<ScaledProblem::Point> starts;
  absl::Status reason;
  const int count = scaled.dimension() == 0 ? 1 : problem.starts;
  for (const VectorXd& place : StartPlaces(scaled.dimension(), count, problem.seed)) {
    auto point = scaled.Evaluate(place, false);
    if (point.ok()) {
      starts.push_back(*std::move(point));
    } else if (absl::IsOutOfRange(point.status()) || absl::IsInvalidArgument(point.status())) {
      reason.Update(point.status());
    } else {
      return point.status();
    }
  }
  if (starts.empty()) return reason;
  return starts;
}

int CountNear(const std::vector<ScaledProblem::Point>& ends, const ScaledProblem::Point& best) {
  return static_cast<int>(std::ranges::count_if(ends, [&best](const auto& end) {
    return end.place.size() == 0 ||
           (end.place - best.place).template lpNorm<Eigen::Infinity>() <= kSamePlace;
  }));
}

}  // namespace

absl::StatusOr<MapOptimum> Optimize(const MapOptimization& problem, const MapFunction& map) {
  if (absl::Status status = CheckProblem(problem); !status.ok()) return status;
  ScaledProblem scaled(problem, map);
  scaled.ListSides();
  auto ends = EvaluateStarts(scaled, problem);
  if (!ends.ok()) return ends.status();
  if (scaled.dimension() > 0) scaled.SetScale(*ends);
  for (ScaledProblem::Point& end : *ends) {
    if (scaled.dimension() == 0) break;
    Search search(scaled, end);
    for (const nlopt_algorithm algorithm : {NLOPT_LD_SLSQP, NLOPT_LN_COBYLA}) {
      search.Run(algorithm);
      if (!search.fault().ok()) return search.fault();
    }
    end = search.best();
  }
  const auto best = std::ranges::min_element(
      *ends, [&](const auto& a, const auto& b) { return scaled.IsBetter(a, b); });
  return MapOptimum{.parameters = best->parameters,
                    .metrics = best->metrics,
                    .objective = best->objective,
                    .violation = scaled.Violation(*best),
                    .starts = static_cast<int>(ends->size()),
                    .starts_that_agree = CountNear(*ends, *best)};
}

}  // namespace mortise::interpolator
