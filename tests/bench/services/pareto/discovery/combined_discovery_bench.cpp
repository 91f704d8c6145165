// Choices and whole numbers: how much of the true front discovery finds by combinations, beside
// what it finds where they are parameters like others, rounded.
//
// Counters: `share` is the archive's hypervolume over the true one, `rounded` the same of the other
// way, both medians; `tried` and `given_up` are combinations, `microseconds` the time of discovery
// itself for one evaluation. Arguments: problem (index into MixedNames), evaluations.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/bench/pareto/benchmark_run.h"
#include "tests/bench/pareto/mixed_problems.h"

namespace mortise::pareto {
namespace {

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

void BM_Combinations(benchmark::State& state) {
  const std::string name = MixedNames()[static_cast<std::size_t>(state.range(0))];
  BenchmarkProblem problem = *MakeMixedProblem(name, MixedDimensions(name));
  std::vector<double> shares, rounded;
  double microseconds = 0, tried = 0, given_up = 0;
  Discovery::Options options;
  options.evaluations = state.range(1);
  options.stall_tracks = 0;
  options.seed = 0;
  for (auto _ : state) {
    ++options.seed;
    problem.rounded = false;
    const BenchmarkResult result = *RunBenchmark(problem, options, false);
    shares.push_back(result.hypervolume / problem.hypervolume);
    microseconds += 1e6 * result.own_seconds / static_cast<double>(result.evaluations);
    tried += static_cast<double>(result.summary.combinations_tried);
    given_up += static_cast<double>(result.summary.combinations_pruned);
    state.PauseTiming();
    problem.rounded = true;
    rounded.push_back(RunBenchmark(problem, options, false)->hypervolume / problem.hypervolume);
    state.ResumeTiming();
  }
  const auto runs = static_cast<double>(options.seed);
  state.counters["share"] = Median(shares);
  state.counters["rounded"] = Median(rounded);
  state.counters["tried"] = tried / runs;
  state.counters["given_up"] = given_up / runs;
  state.counters["microseconds"] = microseconds / runs;
  state.SetLabel(name);
}

BENCHMARK(BM_Combinations)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(5)
    ->ArgsProduct({{0, 1, 2, 3}, {1000, 3000}})
    ->ArgsProduct({{4, 5, 6}, {300, 1000}});

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
