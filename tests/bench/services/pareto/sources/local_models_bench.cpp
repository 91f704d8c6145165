// What discovery spends on a design by itself, without evaluating anything: a local model, a step
// within the models of constraints, polishing, a sample of an evolution search, and what lines tell
// of parameters. Argument: parameters; 1,000 entries.
#include <benchmark/benchmark.h>

#include <cmath>

#include "common/base/random.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/models/constrained_quadratic.h"
#include "services/pareto/models/quadratic_model.h"
#include "services/pareto/sources/evolution_search.h"
#include "services/pareto/sources/front_polishing.h"
#include "services/pareto/sources/parameter_lines.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

constexpr int kEntries = 1000;
constexpr int kConstraints = 4;

// Near the segment between the best designs of two paraboloids, each with constraints.
Archive NearAFront(Eigen::Index parameters) {
  Random random(3);
  Archive archive;
  VectorXd first = VectorXd::Constant(parameters, 0.5), second = first;
  first[0] = 0.2;
  second[0] = 0.8;
  for (int i = 0; i < kEntries; ++i) {
    const VectorXd u =
        first + random.Uniform() * (second - first) + 0.02 * random.UnitVector(parameters);
    ArchiveEntry entry{u, true, {}, {}, {}};
    entry.metrics = Eigen::Vector2d((u - first).squaredNorm(), (u - second).squaredNorm());
    entry.constraints.resize(kConstraints);
    for (int j = 0; j < kConstraints; ++j) {
      entry.constraints[j] = (u - 0.3 * (j + 1) * first).squaredNorm() - 0.1 * parameters;
    }
    archive.Add(std::move(entry));
  }
  return archive;
}

void BM_FitQuadraticModel(benchmark::State& state) {
  const Archive archive = NearAFront(state.range(0));
  std::size_t entry = 0;
  for (auto _ : state) {
    entry = (entry + 37) % kEntries;
    benchmark::DoNotOptimize(FitQuadraticModel(archive, entry, 0.1, {}));
  }
}

void BM_StepWithinConstraints(benchmark::State& state) {
  const Archive archive = NearAFront(state.range(0));
  const Eigen::Index size = state.range(0);
  const std::vector<QuadraticFunction> constraints = ConstraintsAround(
      FitConstraintModel(archive, 0, 0.1, {}), archive[0].u, archive.ConstraintSizes());
  const VectorXd reach = VectorXd::Constant(size, 0.1);
  Random random(4);
  for (auto _ : state) {
    const QuadraticFunction objective{0, random.UnitVector(size),
                                      Eigen::MatrixXd::Identity(size, size)};
    benchmark::DoNotOptimize(MinimizeWithin(objective, constraints, -reach, reach));
  }
}

void BM_Polish(benchmark::State& state) {
  const Archive archive = NearAFront(state.range(0));
  const Scaling scaling = archive.CurrentScaling();
  std::size_t entry = 0;
  for (auto _ : state) {
    entry = (entry + 37) % kEntries;
    benchmark::DoNotOptimize(Polished(archive, scaling, archive[entry].u, 0.02));
  }
}

// A tenth of the entries are on lines.
void BM_LearnFromLines(benchmark::State& state) {
  Archive archive = NearAFront(state.range(0));
  for (int k = 0; k < kEntries / 10; ++k) {
    ArchiveEntry entry = archive[0];
    entry.u[k / 5 % state.range(0)] = 0.2 * (k % 5);
    entry.metrics += Eigen::Vector2d(0.01 * k, -0.01 * k);
    archive.Add(std::move(entry));
  }
  const Scaling scaling = archive.CurrentScaling();
  for (auto _ : state) {
    const std::vector<ParameterLine> lines = ParameterLines(archive);
    benchmark::DoNotOptimize(RelativeLengths(archive, lines, scaling));
    benchmark::DoNotOptimize(TradingParameters(archive, lines, scaling, 0.1));
  }
}

void Sizes(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMicrosecond)->Arg(3)->Arg(12)->Arg(30);
}

// With learning from it, whatever the metrics.
void BM_EvolutionSample(benchmark::State& state) {
  const Archive archive = NearAFront(state.range(0));
  const Scaling scaling = archive.CurrentScaling();
  EvolutionSearch search(5);
  std::size_t entry = 0;
  for (auto _ : state) {
    entry = (entry + 37) % kEntries;
    const EvolutionSearch::Sample sample = search.Next(archive, scaling);
    search.Tell(archive, scaling, sample.search, entry);
  }
}

BENCHMARK(BM_FitQuadraticModel)->Apply(Sizes);
BENCHMARK(BM_StepWithinConstraints)->Apply(Sizes);
BENCHMARK(BM_Polish)->Apply(Sizes);
BENCHMARK(BM_EvolutionSample)->Apply(Sizes);
BENCHMARK(BM_LearnFromLines)->Apply(Sizes);

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
