// Hypervolume of points on the sphere and what one point adds, for metrics and points.
//
// `Contribution` is of a point a little beyond the front, as a commit of discovery measures it:
// exactly, and to the 64 points that overlap it most. Counter `bound`: the sum of those over that
// of the exact ones; `error`: of samples.
#include <benchmark/benchmark.h>

#include "common/base/random.h"
#include "services/pareto/archive/hypervolume.h"

namespace mortise::pareto {
namespace {

std::vector<Eigen::VectorXd> Sphere(const benchmark::State& state) {
  Random random(1);
  std::vector<Eigen::VectorXd> points;
  for (std::int64_t i = 0; i < state.range(1); ++i) {
    points.push_back(random.UnitVector(state.range(0)).cwiseAbs());
  }
  return points;
}

Eigen::VectorXd Reference(const benchmark::State& state) {
  return Eigen::VectorXd::Constant(state.range(0), 1.1);
}

void BM_Exact(benchmark::State& state) {
  const auto points = Sphere(state);
  const Eigen::VectorXd reference = Reference(state);
  for (auto _ : state) benchmark::DoNotOptimize(Hypervolume(points, reference));
}

void BM_Sampled(benchmark::State& state) {
  const auto points = Sphere(state);
  const Eigen::VectorXd reference = Reference(state);
  double volume = 0;
  for (auto _ : state) volume = SampledHypervolume(points, reference, 1 << 18);
  state.counters["error"] = volume / Hypervolume(points, reference) - 1;
}

void Contributions(benchmark::State& state, std::size_t most) {
  const auto points = Sphere(state);
  const Eigen::VectorXd reference = Reference(state);
  Eigen::MatrixXd columns(state.range(0), state.range(1));
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    columns.col(i) = points[static_cast<std::size_t>(i)];
  }
  Random random(2);
  std::vector<Eigen::VectorXd> added;
  for (int i = 0; i < 16; ++i) added.push_back(0.99 * random.UnitVector(state.range(0)).cwiseAbs());
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        HypervolumeContribution(added[next++ % added.size()], columns, reference, most));
  }
  if (most == 0) return;
  double exact = 0, bound = 0;
  for (const Eigen::VectorXd& point : added) {
    exact += HypervolumeContribution(point, columns, reference);
    bound += HypervolumeContribution(point, columns, reference, most);
  }
  state.counters["bound"] = bound / exact;
}

void BM_Contribution(benchmark::State& state) { Contributions(state, 0); }

void BM_ContributionToSome(benchmark::State& state) { Contributions(state, 64); }

void Sizes(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMicrosecond)->Args({2, 5000})->Args({3, 1000})->Args({3, 5000});
  bench->Args({4, 1000})->Args({4, 5000})->Args({5, 500})->Args({5, 2000})->Args({6, 300});
}

BENCHMARK(BM_Exact)->Apply(Sizes);
BENCHMARK(BM_Sampled)->Apply(Sizes);
BENCHMARK(BM_Contribution)->Apply(Sizes);
BENCHMARK(BM_ContributionToSome)->Apply(Sizes);

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
