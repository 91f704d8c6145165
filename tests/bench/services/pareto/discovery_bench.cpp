// How much of the true front discovery finds for a budget of evaluations, beside random search with
// the same budget, and its own time per evaluation.
//
// Counters: `share` is the archive's hypervolume over the true one, `random` the same for uniform
// random designs, `microseconds` the time of discovery itself for one evaluation (the evaluator's
// subtracted). Arguments: problem (index into BenchmarkNames), D, evaluations, gradients.
#include <benchmark/benchmark.h>

#include <chrono>
#include <string>
#include <vector>

#include "services/pareto/benchmark_problems.h"
#include "services/pareto/discovery.h"
#include "services/pareto/hypervolume.h"
#include "services/pareto/random.h"

namespace mortise::pareto {
namespace {

double RandomShare(const BenchmarkProblem& problem, std::int64_t evaluations) {
  Random random(7);
  Archive archive;
  for (std::int64_t k = 0; k < evaluations; ++k) {
    ArchiveEntry entry;
    entry.u.resize(problem.space.size());
    for (double& value : entry.u) value = random.Uniform();
    entry.feasible = true;
    entry.metrics = problem.evaluate(problem.space.FromUnit(entry.u), false).metrics;
    archive.Add(std::move(entry));
  }
  std::vector<Eigen::VectorXd> points;
  for (const std::size_t i : archive.non_dominated()) points.push_back(archive[i].metrics);
  return Hypervolume(points, problem.reference);
}

void BM_Discovery(benchmark::State& state) {
  const std::string name = BenchmarkNames()[static_cast<std::size_t>(state.range(0))];
  const BenchmarkProblem problem = *MakeBenchmarkProblem(name, static_cast<int>(state.range(1)));
  Discovery::Options options;
  options.evaluations = state.range(2);
  options.stall_tracks = 0;
  double share = 0, microseconds = 0;
  std::int64_t runs = 0;
  for (auto _ : state) {
    options.seed = static_cast<std::uint64_t>(++runs);
    auto discovery = *Discovery::Create(problem.space, problem.metric_count, options);
    const auto start = std::chrono::steady_clock::now();
    while (!discovery->Finished()) {
      const auto proposal = discovery->Ask();
      if (!proposal) continue;
      (void)discovery->Tell(proposal->number, problem.evaluate(proposal->x, state.range(3) != 0));
    }
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    microseconds += took.count() / static_cast<double>(options.evaluations);
    std::vector<Eigen::VectorXd> points;
    for (const std::size_t i : discovery->archive().non_dominated())
      points.push_back(discovery->archive()[i].metrics);
    share += Hypervolume(points, problem.reference);
  }
  const double truth = problem.hypervolume > 0 ? problem.hypervolume : 1;
  state.counters["share"] = share / static_cast<double>(runs) / truth;
  state.counters["random"] = RandomShare(problem, options.evaluations) / truth;
  state.counters["microseconds"] = microseconds / static_cast<double>(runs);
  state.SetLabel(name + (state.range(3) != 0 ? " gradients" : " values"));
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
    ->Args({8, 3, 300, 0})
    ->Args({8, 3, 1000, 0})
    ->Args({9, 3, 300, 0})
    ->Args({9, 3, 300, 1});

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
