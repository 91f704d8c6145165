// The labelling of a triangular buffer of 200 × 200 cells with 30 labels, neighbours within two
// cells, as for a front of three metrics.
//
// Counters: `cells`, `pairs`, `energy` over that of the cheapest label everywhere. Argument: how
// far the pieces of the labels reach, in cells; 0: every label is a candidate everywhere, with a
// random cost, which no front is.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/front/alpha_expansion.h"

namespace mortise::pareto {
namespace {

constexpr int kSide = 200;
constexpr int kLabels = 30;

LabelingProblem TriangularBuffer(double reach) {
  Random random(1);
  std::vector<std::pair<double, double>> centres;
  for (int label = 0; label < kLabels; ++label) {
    const double x = kSide * random.Uniform();
    centres.emplace_back(x, kSide * random.Uniform());
  }
  LabelingProblem problem;
  problem.labels = kLabels;
  std::map<std::pair<int, int>, int> index;
  for (int i = 0; i < kSide; ++i) {
    for (int k = 0; i + k < kSide; ++k) {
      index[{i, k}] = static_cast<int>(problem.candidates.size());
      auto& candidates = problem.candidates.emplace_back();
      for (int label = 0; label < kLabels; ++label) {
        const double cost = random.Uniform();
        const double distance = std::hypot(i - centres[label].first, k - centres[label].second);
        if (reach == 0) {
          candidates.push_back({label, cost});
        } else if (label == 0 || distance < reach) {
          candidates.push_back({label, 0.7 * std::min(1.0, distance / reach) + 0.3 * cost});
        }
      }
    }
  }
  for (const auto& [place, site] : index) {
    for (int i = 0; i <= 2; ++i) {
      for (int k = i == 0 ? 1 : -2; k <= 2; ++k) {
        const auto other = index.find({place.first + i, place.second + k});
        if (i * i + k * k <= 4 && other != index.end()) {
          problem.neighbours.emplace_back(site, other->second);
        }
      }
    }
  }
  return problem;
}

void BM_TriangularBuffer(benchmark::State& state) {
  const LabelingProblem problem = TriangularBuffer(static_cast<double>(state.range(0)));
  std::vector<int> cheapest;
  for (const auto& candidates : problem.candidates) {
    LabelCost least = candidates.front();
    for (const LabelCost& candidate : candidates) {
      if (candidate.cost < least.cost) least = candidate;
    }
    cheapest.push_back(least.label);
  }
  double energy = 0;
  for (auto _ : state) energy = LabelingEnergy(problem, *MinimizeByExpansion(problem));
  state.counters["cells"] = static_cast<double>(problem.candidates.size());
  state.counters["pairs"] = static_cast<double>(problem.neighbours.size());
  state.counters["energy"] = energy / LabelingEnergy(problem, cheapest);
}

BENCHMARK(BM_TriangularBuffer)->Unit(benchmark::kMillisecond)->Arg(30)->Arg(60)->Arg(0);

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
