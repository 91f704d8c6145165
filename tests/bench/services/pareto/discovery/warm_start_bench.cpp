// What a front of before saves after a bound or a metric has changed: evaluations until the
// hypervolume is 99 % of what there is, from nothing and from the earlier front, median of eleven
// seeds. What there is: the best of long runs from either.
//
// Counters: `cold` and `warm` evaluations (the budget where it was not reached), `share_cold` and
// `share_warm` of the hypervolume at the end of the budget. Argument: the case.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "services/pareto/archive/hypervolume.h"
#include "services/pareto/discovery/discovery.h"
#include "services/pareto/discovery/warm_start.h"
#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSeeds = 11;
constexpr double kShare = 0.99;

struct Problem {
  DesignSpace space;
  std::function<VectorXd(const VectorXd&)> metrics;
};

struct Case {
  std::string name;
  std::int64_t evaluations;
  Problem before, after;
};

Problem Published(const std::string& name, int dimensions, const BenchmarkVariant& variant) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem(name, dimensions, variant);
  return {problem.space,
          [problem](const VectorXd& x) { return problem.evaluate(x, false).metrics; }};
}

// Mass and deflection of a table under `load`: height, leg, apron and top vary.
Problem Table(double length, double load, double thickest) {
  Problem table;
  table.space.lower = Eigen::Vector4d(0.6, 0.03, 0.04, 0.012);
  table.space.upper = Eigen::Vector4d(0.8, 0.09, 0.15, thickest);
  table.metrics = [=](const VectorXd& x) -> VectorXd {
    const double width = 0.7, modulus = 10e9, rail = 0.02;
    const double mass =
        700 * (length * width * x[3] + 4 * x[1] * x[1] * x[0] + 2 * rail * x[2] * (length + width));
    const double bending = width * std::pow(x[3], 3) / 12 + rail * std::pow(x[2], 3) / 6;
    const double deflection = load * std::pow(length, 3) / (48 * modulus * bending) +
                              load * x[0] / (4 * modulus * x[1] * x[1]) +
                              load * 0.05 * std::pow(x[0], 3) / (modulus * std::pow(x[1], 4));
    return Eigen::Vector2d(mass, deflection);
  };
  return table;
}

// One metric of another instance mixed into the second.
Problem Mixed(const Problem& first, const Problem& second, double part) {
  return {first.space, [=](const VectorXd& x) -> VectorXd {
            VectorXd metrics = first.metrics(x);
            metrics[1] = (1 - part) * metrics[1] + part * second.metrics(x)[1];
            return metrics;
          }};
}

// The distance parameters measured from elsewhere: all optima move by `by`.
Problem Moved(const Problem& problem, double by) {
  return {
      problem.space, [=](const VectorXd& x) {
        VectorXd moved = x;
        moved.tail(x.size() - 1).array() -= by;
        return problem.metrics(moved.cwiseMax(problem.space.lower).cwiseMin(problem.space.upper));
      }};
}

Problem Bounded(Problem problem, double lower, double upper) {
  const VectorXd range = problem.space.upper - problem.space.lower;
  problem.space.upper = problem.space.lower + upper * range;
  problem.space.lower += lower * range;
  return problem;
}

std::vector<Case> Cases() {
  const Problem fourier = Published("Fourier", 3, {.instance = 1});
  const Problem other = Published("Fourier", 3, {.instance = 2});
  const Problem third = Published("Fourier", 3, {.instance = 3});
  const Problem turned = Published("ZDT1", 15, {true, true, 3});
  const Problem dtlz = Published("DTLZ2", 12, {true, true, 3});
  return {
      {"Fourier, upper bounds to 80 %", 600, fourier, Bounded(fourier, 0, 0.8)},
      {"Fourier, upper bounds from 80 %", 600, Bounded(fourier, 0, 0.8), fourier},
      {"Fourier, a fifth of the second metric another", 600, fourier, Mixed(fourier, other, 0.2)},
      {"Fourier, the second metric another", 600, fourier, Mixed(fourier, other, 1)},
      {"another Fourier, a fifth of the second metric another", 600, third,
       Mixed(third, other, 0.2)},
      {"ZDT1-15 rotated, optima moved by 0.03", 3000, turned, Moved(turned, 0.03)},
      {"DTLZ2-12 rotated, optima moved by 0.03", 2000, dtlz, Moved(dtlz, 0.03)},
      {"table, longer", 200, Table(1.2, 1000, 0.04), Table(1.5, 1000, 0.04)},
      {"table, thinner top", 200, Table(1.2, 1000, 0.04), Table(1.2, 1000, 0.025)},
      {"table, thicker top", 200, Table(1.2, 1000, 0.025), Table(1.2, 1000, 0.04)},
      {"table, twice the load", 200, Table(1.2, 1000, 0.04), Table(1.2, 2000, 0.04)}};
}

struct Run {
  std::unique_ptr<Discovery> discovery;
  std::vector<VectorXd> metrics;  // in the order evaluated
};

Run Discover(const Problem& problem, std::int64_t evaluations, std::uint64_t seed,
             const MatrixXd& start) {
  Discovery::Options options;
  options.evaluations = evaluations;
  options.seed = seed;
  options.stall_tracks = 0;
  options.initial_designs = start;
  const VectorXd middle = problem.metrics(problem.space.lower);
  Run run{*Discovery::Create(problem.space, middle.size(), options), {}};
  while (!run.discovery->Finished()) {
    const auto proposal = run.discovery->Ask();
    if (!proposal) continue;
    Evaluation evaluation;
    evaluation.x = proposal->x;
    evaluation.status = EvaluationStatus::kEvaluated;
    evaluation.metrics = problem.metrics(proposal->x);
    run.metrics.push_back(evaluation.metrics);
    benchmark::DoNotOptimize(run.discovery->Tell(proposal->number, std::move(evaluation)));
  }
  return run;
}

MatrixXd StartFrom(const Run& run, const Problem& problem, std::int64_t evaluations) {
  const Front front = run.discovery->front();
  EarlierFront earlier;
  const auto count = static_cast<Eigen::Index>(front.points.size());
  earlier.designs.resize(problem.space.size(), count);
  earlier.metrics.resize(front.points.front().metrics.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    earlier.designs.col(i) = front.points[static_cast<std::size_t>(i)].x;
    earlier.metrics.col(i) = front.points[static_cast<std::size_t>(i)].metrics;
  }
  return StartDesigns(problem.space, {earlier},
                      MostStartDesigns(evaluations, earlier.metrics.rows()));
}

// Of the box from the ideal to the nadir of all that was ever found.
struct Measure {
  VectorXd ideal, nadir;
  double Share(const std::vector<VectorXd>& metrics, std::size_t count) const {
    std::vector<VectorXd> points;
    for (std::size_t i = 0; i < count; ++i) {
      points.push_back((metrics[i] - ideal).cwiseQuotient(nadir - ideal));
    }
    return Hypervolume(points, VectorXd::Constant(ideal.size(), 1.1));
  }
};

Measure MeasureOf(const Archive& archive) {
  const Scaling scaling = archive.CurrentScaling();
  return {scaling.ideal, scaling.ideal + scaling.range};
}

double Evaluations(const Run& run, const Measure& measure, double wanted) {
  std::size_t low = 0, high = run.metrics.size();
  if (measure.Share(run.metrics, high) < wanted) return static_cast<double>(high);
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (measure.Share(run.metrics, middle) < wanted ? low : high) = middle;
  }
  return static_cast<double>(high);
}

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

void BM_WarmStart(benchmark::State& state) {
  const Case changed = Cases()[static_cast<std::size_t>(state.range(0))];
  const std::int64_t budget = changed.evaluations;
  for (auto _ : state) {
    const Run known = Discover(changed.after, 5 * budget, 99, {});
    const Measure measure = MeasureOf(known.discovery->archive());
    std::vector<Run> cold, warm;
    double best = measure.Share(known.metrics, known.metrics.size());
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const Run earlier = Discover(changed.before, budget, seed, {});
      cold.push_back(Discover(changed.after, budget, seed, {}));
      warm.push_back(
          Discover(changed.after, budget, seed, StartFrom(earlier, changed.after, budget)));
      for (const Run* run : {&cold.back(), &warm.back()}) {
        best = std::max(best, measure.Share(run->metrics, run->metrics.size()));
      }
    }
    const auto median = [&](const std::vector<Run>& runs, auto value) {
      std::vector<double> values;
      for (const Run& run : runs) values.push_back(value(run));
      return Median(std::move(values));
    };
    const auto evaluations = [&](const Run& run) {
      return Evaluations(run, measure, kShare * best);
    };
    const auto share = [&](const Run& run) {
      return measure.Share(run.metrics, run.metrics.size()) / best;
    };
    state.counters["cold"] = median(cold, evaluations);
    state.counters["warm"] = median(warm, evaluations);
    state.counters["share_cold"] = median(cold, share);
    state.counters["share_warm"] = median(warm, share);
  }
  state.SetLabel(changed.name);
}

BENCHMARK(BM_WarmStart)->Unit(benchmark::kMillisecond)->Iterations(1)->DenseRange(0, 10);

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
