#include "tests/bench/services/pareto/front/brute_force_front.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "services/pareto/archive/non_dominated.h"
#include "services/pareto/front/front_error.h"
#include "services/pareto/front/front_labeling.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t kCandidates = 4;  // of each cell, to optimise from
constexpr int kRounds = 12;             // of filling gaps
constexpr double kJoining = 0.1;  // designs nearer than this are one stretch; unit coordinates

// The angles of the ray from the ideal.
VectorXd AnglesOf(const VectorXd& scaled) {
  const VectorXd y = scaled.cwiseMax(0.0);
  VectorXd angles(y.size() - 1);
  for (Index k = 0; k < angles.size(); ++k) {
    angles[k] = std::atan2(y.tail(y.size() - 1 - k).norm(), y[k]) / (std::numbers::pi / 2);
  }
  return angles;
}

struct GridPoint {
  VectorXd u;
  VectorXd metrics;
};

void ForEachOfGrid(const BenchmarkProblem& problem, int steps,
                   const std::function<void(GridPoint)>& use) {
  std::vector<int> at(static_cast<std::size_t>(problem.space.size()), 0);
  for (;;) {
    VectorXd u(problem.space.size());
    for (Index i = 0; i < u.size(); ++i) {
      u[i] = static_cast<double>(at[static_cast<std::size_t>(i)]) / (steps - 1);
    }
    use({u, problem.evaluate(problem.space.FromUnit(u), false).metrics});
    std::size_t i = 0;
    while (i < at.size() && ++at[i] == steps) at[i++] = 0;
    if (i == at.size()) return;
  }
}

// The optimisation of Eq. 7.8 again and again, as one reaches no further than its reference point.
PushedDesign PushToFront(const BenchmarkProblem& problem, const Scaling& scaling,
                         const VectorXd& u) {
  constexpr double kReach = 0.1, kArrived = 1e-9;
  PushedDesign pushed{problem.space.FromUnit(u), {}, 1};
  double reach = kReach;
  for (int round = 0; round < 30 && pushed.error > kArrived; ++round) {
    pushed = PushAlongNormal(
        problem.space, scaling, [&](const VectorXd& x) { return problem.evaluate(x, true); },
        pushed.x, reach);
    reach = pushed.error > 0.9 * reach ? 2 * reach : kReach;
  }
  return pushed;
}

// The best of each metric by itself, from the best of the grid.
std::vector<PushedDesign> BestOfEach(const BenchmarkProblem& problem, int steps) {
  const Index d = problem.metric_count;
  std::vector<GridPoint> best(static_cast<std::size_t>(d));
  VectorXd worst;
  ForEachOfGrid(problem, steps, [&](const GridPoint& point) {
    worst = worst.size() == 0 ? point.metrics : VectorXd(worst.cwiseMax(point.metrics));
    for (Index j = 0; j < d; ++j) {
      GridPoint& of_metric = best[static_cast<std::size_t>(j)];
      if (of_metric.u.size() == 0 || point.metrics[j] < of_metric.metrics[j]) of_metric = point;
    }
  });
  std::vector<PushedDesign> found;
  for (Index j = 0; j < d; ++j) {
    BenchmarkProblem alone = problem;
    alone.metric_count = 1;
    alone.evaluate = [&problem, j](const VectorXd& x, bool gradients) {
      Evaluation evaluation = problem.evaluate(x, gradients);
      evaluation.metrics = evaluation.metrics.segment(j, 1).eval();
      if (gradients) evaluation.jacobian = evaluation.jacobian.row(j).eval();
      return evaluation;
    };
    const GridPoint& start = best[static_cast<std::size_t>(j)];
    const Scaling scaling{start.metrics.segment(j, 1), (worst - start.metrics).segment(j, 1)};
    found.push_back(PushToFront(alone, scaling, start.u));
    found.back().metrics = problem.evaluate(found.back().x, false).metrics;
  }
  return found;
}

// From the best of each metric to the worst that these have.
Scaling CornersOf(const std::vector<PushedDesign>& best) {
  VectorXd ideal = best.front().metrics, nadir = ideal;
  for (const PushedDesign& each : best) {
    ideal = ideal.cwiseMin(each.metrics).eval();
    nadir = nadir.cwiseMax(each.metrics).eval();
  }
  return {ideal, (nadir - ideal).cwiseMax(1e-12)};
}

std::vector<std::size_t> OrderAlong(const std::vector<VectorXd>& performance) {
  std::vector<std::size_t> order(performance.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) {
    const VectorXd angles = AnglesOf(performance[i]);
    return std::vector<double>(angles.begin(), angles.end());
  });
  return order;
}

// Whether the straight line from one of these designs to another performs like what lies between.
bool IsStraight(const BenchmarkProblem& problem, const BruteForceFront& front,
                const std::vector<std::size_t>& of, std::size_t from, std::size_t to,
                double tolerance) {
  const VectorXd& a = front.designs[of[from]];
  const VectorXd along = front.designs[of[to]] - a;
  const double length = along.squaredNorm();
  for (std::size_t j = from + 1; j < to && length > 0; ++j) {
    const double t = std::clamp(along.dot(front.designs[of[j]] - a) / length, 0.0, 1.0);
    const VectorXd metrics = problem.evaluate(problem.space.FromUnit(a + t * along), false).metrics;
    if ((front.scaling.Apply(metrics) - front.performance[of[j]]).norm() > tolerance) return false;
  }
  return true;
}

// Makes the ideal of what has been found the origin, and its nadir (1, ..., 1): those of the grid
// are a little off, which on a short front is much.
void Rescale(Scaling& scaling, std::vector<VectorXd>& performance) {
  VectorXd least = performance.front(), most = least;
  for (const VectorXd& each : performance) {
    least = least.cwiseMin(each).eval();
    most = most.cwiseMax(each).eval();
  }
  for (VectorXd& each : performance) {
    each = (each - least).cwiseQuotient((most - least).cwiseMax(1e-12)).eval();
  }
  scaling.ideal += scaling.range.cwiseProduct(least);
  scaling.range = scaling.range.cwiseProduct((most - least).cwiseMax(1e-12)).eval();
}

// Adds what optimisations from designs find, and keeps what nothing dominates, along the front.
void AddPushed(const BenchmarkProblem& problem, const std::vector<VectorXd>& starts,
               BruteForceFront& front) {
  std::vector<VectorXd> designs = front.designs, performance = front.performance;
  for (const VectorXd& u : starts) {
    const PushedDesign pushed = PushToFront(problem, front.scaling, u);
    designs.push_back(problem.space.ToUnit(pushed.x));
    performance.push_back(front.scaling.Apply(pushed.metrics));
  }
  std::vector<VectorXd> kept_designs, kept_performance;
  for (const std::size_t i : NonDominated(performance)) {
    kept_designs.push_back(designs[i]);
    kept_performance.push_back(performance[i]);
  }
  Rescale(front.scaling, kept_performance);
  front.designs.clear();
  front.performance.clear();
  for (const std::size_t i : OrderAlong(kept_performance)) {
    front.designs.push_back(kept_designs[i]);
    front.performance.push_back(kept_performance[i]);
  }
}

// Pairs of neighbours along the front whose designs are within `joining` of each other.
std::vector<std::pair<std::size_t, std::size_t>> Joined(const BruteForceFront& front,
                                                        double joining) {
  std::vector<std::pair<std::size_t, std::size_t>> joined;
  if (front.designs.empty()) return joined;
  Eigen::MatrixXd angles(front.performance.front().size() - 1,
                         static_cast<Index>(front.performance.size()));
  for (Index i = 0; i < angles.cols(); ++i) {
    angles.col(i) = AnglesOf(front.performance[static_cast<std::size_t>(i)]);
  }
  for (const auto& [i, k] : NeighboursAlong(angles)) {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(k);
    if ((front.designs[a] - front.designs[b]).norm() <= joining) joined.emplace_back(a, b);
  }
  return joined;
}

// Half way between neighbours that are too far apart.
std::vector<VectorXd> WithinGaps(const BruteForceFront& front) {
  if (front.performance.empty()) return {};
  const double spacing = front.performance.front().size() == 2 ? 1e-3 : 2e-2;
  std::vector<VectorXd> middles;
  for (const auto& [a, b] : Joined(front, kJoining)) {
    if ((front.performance[a] - front.performance[b]).norm() > spacing) {
      middles.push_back(0.5 * (front.designs[a] + front.designs[b]));
    }
  }
  return middles;
}

}  // namespace

BruteForceFront FindByBruteForce(const BenchmarkProblem& problem, int steps) {
  BruteForceFront front;
  const std::vector<PushedDesign> corners = BestOfEach(problem, steps);
  front.scaling = CornersOf(corners);
  const int cells = problem.metric_count == 2 ? 1000 : 60;
  std::map<std::vector<int>, std::multimap<double, VectorXd>> best;
  ForEachOfGrid(problem, steps, [&](const GridPoint& point) {
    const VectorXd scaled = front.scaling.Apply(point.metrics);
    std::vector<int> cell;
    for (const double angle : AnglesOf(scaled)) cell.push_back(static_cast<int>(angle * cells));
    auto& kept = best[cell];
    kept.emplace(scaled.norm(), point.u);
    if (kept.size() > kCandidates) kept.erase(std::prev(kept.end()));
  });
  std::vector<VectorXd> starts;
  for (const PushedDesign& corner : corners) {
    front.designs.push_back(problem.space.ToUnit(corner.x));
    front.performance.push_back(front.scaling.Apply(corner.metrics));
  }
  for (const auto& [cell, kept] : best) {
    for (const auto& [distance, u] : kept) starts.push_back(u);
  }
  for (int round = 0; round < kRounds && !starts.empty(); ++round) {
    AddPushed(problem, starts, front);
    starts = WithinGaps(front);
  }
  return front;
}

std::vector<int> StretchesOf(const BruteForceFront& front) {
  std::vector<std::size_t> parent(front.designs.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i];
    return i;
  };
  for (const auto& [a, b] : Joined(front, kJoining)) parent[root(a)] = root(b);
  std::map<std::size_t, int> numbers;
  std::vector<int> stretches;
  for (std::size_t i = 0; i < parent.size(); ++i) {
    stretches.push_back(
        numbers.try_emplace(root(i), static_cast<int>(numbers.size())).first->second);
  }
  return stretches;
}

int CountStraightPieces(const BenchmarkProblem& problem, const BruteForceFront& front,
                        double tolerance) {
  if (problem.metric_count != 2) return 0;
  const std::vector<int> stretches = StretchesOf(front);
  std::map<int, std::vector<std::size_t>> points;
  for (std::size_t i = 0; i < stretches.size(); ++i) points[stretches[i]].push_back(i);
  int pieces = 0;
  for (const auto& [stretch, of] : points) {
    for (std::size_t from = 0; from < of.size(); ++pieces) {
      std::size_t to = from + 1;
      while (to < of.size() && IsStraight(problem, front, of, from, to, tolerance)) ++to;
      from = to;
    }
  }
  return pieces;
}

}  // namespace mortise::pareto
