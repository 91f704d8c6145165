// What a surrogate costs: fitting one process anew, and proposing a design for two metrics, with
// its hyperparameters fitted anew (`fresh`) and without. Arguments: points, parameters.
#include <benchmark/benchmark.h>

#include "services/pareto/archive/stochastic_sampling.h"
#include "services/pareto/models/gaussian_process.h"
#include "services/pareto/sources/surrogate_search.h"

namespace mortise::pareto {
namespace {

Archive Sampled(std::int64_t count, Eigen::Index D) {
  Random random(1);
  Archive archive;
  for (const Eigen::VectorXd& u : LatinHypercube(count, D, random)) {
    ArchiveEntry entry;
    entry.u = u;
    entry.evaluated = true;
    entry.metrics = Eigen::Vector2d((u.array() - 0.25).square().sum(),
                                    (u.array() - 0.75).abs().sum() + 0.1 * u[0] * u[1]);
    archive.Add(entry);
  }
  return archive;
}

void BM_Fit(benchmark::State& state) {
  const Archive archive = Sampled(state.range(0), state.range(1));
  Eigen::MatrixXd points(state.range(1), state.range(0));
  Eigen::VectorXd values(state.range(0));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    points.col(k) = archive[static_cast<std::size_t>(k)].u;
    values[k] = archive[static_cast<std::size_t>(k)].metrics[0];
  }
  for (auto _ : state) benchmark::DoNotOptimize(GaussianProcess::Fit(points, values));
}

void BM_Propose(benchmark::State& state) {
  const Archive archive = Sampled(state.range(0), state.range(1));
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(state.range(1));
  const DesignSpace box{none, none.array() + 1};
  SurrogateSearch search({}, box, 1);
  search.Next(archive, {});  // its hyperparameters are kept
  for (auto _ : state) {
    if (state.range(2) != 0) {
      state.PauseTiming();
      search = SurrogateSearch({}, box, 1);
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(search.Next(archive, {}));
  }
  state.SetLabel(state.range(2) != 0 ? "fresh" : "");
}

BENCHMARK(BM_Fit)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(3)
    ->ArgsProduct({{50, 200, 500}, {3, 12, 30}});
BENCHMARK(BM_Propose)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(3)
    ->ArgsProduct({{50, 200, 500}, {3, 12, 30}, {0, 1}});

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
