// Questions about a front in memory: each must be answered in less than 0.2 ms.
//
// Arguments: metrics and points; 21 parameters, as the lamp has.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "common/base/random.h"
#include "services/pareto/front/front_exploration.h"

namespace mortise::pareto {
namespace {

constexpr int kParameters = 21;
constexpr int kPieces = 5;

FrontPoints RandomFront(int metrics, int count) {
  Random random(1);
  FrontPoints points;
  points.parameters.resize(kParameters, count);
  points.metrics.resize(metrics, count);
  points.embedding.resize(metrics - 1, count);
  points.signs = Eigen::VectorXd::Ones(metrics);
  points.ranges = Eigen::VectorXd::Ones(kParameters);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < kParameters; ++k) points.parameters(k, i) = random.Uniform();
    for (int k = 0; k + 1 < metrics; ++k) points.embedding(k, i) = random.Uniform();
    if (metrics == 2) points.embedding(0, i) = (i + 0.5) / count;
    double rest = 1;
    for (int k = 0; k + 1 < metrics; ++k) {
      const double angle = points.embedding(k, i) * std::numbers::pi / 2;
      points.metrics(k, i) = rest * std::cos(angle);
      rest *= std::sin(angle);
    }
    points.metrics(metrics - 1, i) = rest;
    points.piece.push_back(static_cast<int>(random.Index(kPieces)));
  }
  return points;
}

FrontExploration Explored(const benchmark::State& state) {
  return FrontExploration(
      RandomFront(static_cast<int>(state.range(0)), static_cast<int>(state.range(1))));
}

void BM_PickWithNeighboursAndImprovements(benchmark::State& state) {
  const FrontExploration front = Explored(state);
  double position = 0;
  for (auto _ : state) {
    position = std::fmod(position + 0.37, 1.0);
    const int point = *front.AtEmbedding(Eigen::VectorXd::Constant(state.range(0) - 1, position));
    benchmark::DoNotOptimize(front.NeighboursOf(point));
    benchmark::DoNotOptimize(front.ImprovementsAt(point));
  }
}

void BM_Restrict(benchmark::State& state) {
  const FrontExploration front = Explored(state);
  for (auto _ : state) {
    benchmark::DoNotOptimize(front.Within({{true, 0, 0.1, 0.9}, {false, 3, 0.1, std::nullopt}}));
  }
}

void BM_WalkOneStep(benchmark::State& state) {
  const FrontExploration front = Explored(state);
  const int middle = front.size() / 2;
  for (auto _ : state) benchmark::DoNotOptimize(front.Walk(middle, 0, 1));
}

void Sizes(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMicrosecond)->Args({2, 1000})->Args({3, 1000})->Args({3, 5000});
}

BENCHMARK(BM_PickWithNeighboursAndImprovements)->Apply(Sizes);
BENCHMARK(BM_Restrict)->Apply(Sizes);
BENCHMARK(BM_WalkOneStep)->Apply(Sizes);

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
