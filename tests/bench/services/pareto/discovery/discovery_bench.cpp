// How much of the true front discovery finds for a budget of evaluations, beside random search with
// the same budget, and its own time per evaluation.
//
// Counters: `share` is the archive's hypervolume over the true one, `random` the same for uniform
// random designs, `microseconds` the time of discovery itself for one evaluation (the evaluator's
// subtracted). Arguments: problem (index into BenchmarkNames), D, evaluations, and 1 with gradients
// or 2 for a rotated and shifted problem, another one each run.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/hypervolume.h"
#include "tests/bench/pareto/benchmark_run.h"

namespace mortise::pareto {
namespace {

double RandomShare(const BenchmarkProblem& problem, std::int64_t evaluations) {
  Random random(7);
  Archive archive;
  for (std::int64_t k = 0; k < evaluations; ++k) {
    ArchiveEntry entry;
    entry.u.resize(problem.space.size());
    for (double& value : entry.u) value = random.Uniform();
    entry.evaluated = true;
    const Evaluation evaluation = problem.evaluate(problem.space.FromUnit(entry.u), false);
    entry.metrics = evaluation.metrics;
    entry.constraints = evaluation.constraints;
    archive.Add(std::move(entry));
  }
  std::vector<Eigen::VectorXd> points;
  for (const std::size_t i : archive.non_dominated()) points.push_back(archive[i].metrics);
  return Hypervolume(points, problem.reference);
}

void BM_Discovery(benchmark::State& state) {
  const std::string name = BenchmarkNames()[static_cast<std::size_t>(state.range(0))];
  const bool gradients = state.range(3) == 1, turned = state.range(3) == 2;
  double share = 0, microseconds = 0, random = 0;
  std::int64_t runs = 0;
  for (auto _ : state) {
    ++runs;
    const auto seed = static_cast<std::uint64_t>(runs);
    const BenchmarkProblem problem =
        *MakeBenchmarkProblem(name, static_cast<int>(state.range(1)), {turned, turned, seed});
    const double truth = problem.hypervolume > 0 ? problem.hypervolume : 1;
    Discovery::Options options;
    options.evaluations = state.range(2);
    options.stall_tracks = 0;
    options.seed = seed;
    const BenchmarkResult result = *RunBenchmark(problem, options, gradients);
    microseconds += 1e6 * result.own_seconds / static_cast<double>(result.evaluations);
    share += result.hypervolume / truth;
    state.PauseTiming();
    random += RandomShare(problem, options.evaluations) / truth;
    state.ResumeTiming();
  }
  state.counters["share"] = share / static_cast<double>(runs);
  state.counters["random"] = random / static_cast<double>(runs);
  state.counters["microseconds"] = microseconds / static_cast<double>(runs);
  state.SetLabel(name + (gradients ? " gradients" : turned ? " rotated shifted" : ""));
}

BENCHMARK(BM_Discovery)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(3)
    ->Args({0, 15, 300, 1})
    ->Args({0, 15, 1000, 0})
    ->Args({1, 15, 1000, 0})
    ->Args({0, 30, 1000, 0})
    ->Args({1, 30, 1000, 0})
    ->Args({2, 30, 1000, 0})
    ->Args({3, 10, 6000, 0})
    ->Args({4, 30, 3000, 0})
    ->Args({5, 7, 3000, 0})
    ->Args({6, 12, 1000, 0})
    ->Args({6, 12, 3000, 0})
    ->Args({7, 12, 3000, 0})
    ->Args({11, 22, 1000, 0})
    ->Args({12, 3, 1000, 0})
    ->Args({13, 3, 300, 0})
    ->Args({13, 3, 300, 1})
    ->Args({14, 2, 400, 0})
    ->Args({15, 2, 400, 0})
    ->Args({16, 2, 1000, 0})
    ->Args({17, 6, 1000, 0})
    ->Args({0, 30, 3000, 2})
    ->Args({6, 12, 3000, 2})
    ->Args({11, 22, 3000, 2});

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
