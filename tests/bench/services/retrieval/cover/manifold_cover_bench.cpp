// Covers of small families with 3, 5 and 7 parameters, whose descriptor is a D2 of some fifty
// points, and of a paraboloid: cost against δ (Figure 4-9), and measured errors (Figure 4-8).
// Arguments: parameters (2: the paraboloid), δ in thousandths. Counters: `cost` of the mixed cover,
// of `points` alone and of `tangents` alone, `unraced` that of the mixed one without a race,
// `tangent_share` the part of primitives that are tangents, `per_sample` evaluations over samples,
// `coverage` and `fitting` the 99th percentile of errors over δ.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "services/retrieval/cover/cover_error.h"
#include "services/retrieval/cover/manifold_cover.h"
#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

void SetErrors(const Manifold& manifold, const Cover& cover, double delta,
               benchmark::State& state) {
  const ErrorSampling sampling{.count = 1000, .seed = 77};
  const auto coverage = CoverageErrors(manifold, cover.primitives, sampling);
  const auto fitting = FittingErrors(manifold, cover.primitives, sampling);
  if (!coverage.ok() || !fitting.ok()) return state.SkipWithError("no errors");
  state.counters["coverage"] = Quantile(*coverage, 0.99) / delta;
  state.counters["fitting"] = Quantile(*fitting, 0.99) / delta;
}

void BM_Cover(benchmark::State& state) {
  const int parameters = static_cast<int>(state.range(0));
  const testing::ToyFamily family(std::max(3, parameters));
  const FunctionManifold manifold(parameters == 2 ? testing::Paraboloid() : family.Functions());
  CoverOptions options{.delta = 1e-3 * static_cast<double>(state.range(1)), .seed = 5};
  options.most_primitives = 20'000;
  Cover cover;
  for (auto _ : state) {
    auto made = CoverManifold(manifold, options);
    if (!made.ok()) return state.SkipWithError(made.status().ToString().c_str());
    cover = *std::move(made);
  }
  const auto tangents = std::count_if(cover.primitives.begin(), cover.primitives.end(),
                                      [](const Primitive& each) { return each.axes.cols() > 0; });
  state.counters["cost"] = static_cast<double>(cover.cost);
  state.counters["tangent_share"] =
      static_cast<double>(tangents) / static_cast<double>(cover.primitives.size());
  state.counters["per_sample"] =
      static_cast<double>(cover.evaluations) / static_cast<double>(cover.samples);
  state.counters["samples"] = static_cast<double>(cover.samples);
  SetErrors(manifold, cover, options.delta, state);
  options.race = false;
  state.counters["unraced"] = static_cast<double>(CoverManifold(manifold, options)->cost);
  options.kind = CoverKind::kPoints;
  state.counters["points"] = static_cast<double>(CoverManifold(manifold, options)->cost);
  options.kind = CoverKind::kTangents;
  state.counters["tangents"] = static_cast<double>(CoverManifold(manifold, options)->cost);
}

BENCHMARK(BM_Cover)
    ->ArgsProduct({{2}, {5, 10, 20, 50, 100, 200}})
    ->ArgsProduct({{3}, {5, 10, 20, 40, 80}})
    ->ArgsProduct({{5}, {10, 20, 40, 80}})
    ->ArgsProduct({{7}, {20, 40, 80}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::retrieval

BENCHMARK_MAIN();
