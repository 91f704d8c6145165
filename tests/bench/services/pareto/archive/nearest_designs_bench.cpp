// The 60 designs nearest to one, among designs near a front: `ratio` of looking at all of them over
// looking at some (nearest_designs.h). Arguments: parameters, designs, dimensions of the front.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/nearest_designs.h"

namespace mortise::pareto {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kCount = 60;

MatrixXd NearAFront(Eigen::Index parameters, Eigen::Index count, Eigen::Index dimensions) {
  Random random(3);
  MatrixXd designs(parameters, count);
  for (auto column : designs.colwise()) {
    column = VectorXd::Constant(parameters, 0.5) + 0.05 * random.UnitVector(parameters);
    for (Eigen::Index i = 0; i < dimensions; ++i) column[i] = random.Uniform();
  }
  return designs;
}

std::vector<std::pair<double, std::size_t>> LookAtAll(const MatrixXd& designs, const VectorXd& u) {
  std::vector<std::pair<double, std::size_t>> all;
  for (Eigen::Index i = 0; i < designs.cols(); ++i) {
    all.emplace_back((designs.col(i) - u).squaredNorm(), static_cast<std::size_t>(i));
  }
  std::partial_sort(all.begin(), all.begin() + kCount, all.end());
  return all;
}

void BM_NearestDesigns(benchmark::State& state) {
  const MatrixXd designs = NearAFront(state.range(0), state.range(1), state.range(2));
  const NearestDesigns::Designs view(designs.data(), designs.rows(), designs.cols());
  NearestDesigns nearest;
  for (Eigen::Index i = 0; i < designs.cols(); ++i) nearest.Add(static_cast<std::size_t>(i), view);
  const VectorXd weights = VectorXd::Ones(designs.rows());
  double some = 0, all = 0;
  Eigen::Index at = 0;
  for (auto _ : state) {
    at = (at + 37) % designs.cols();
    const VectorXd u = designs.col(at);
    const Clock::time_point begin = Clock::now();
    benchmark::DoNotOptimize(nearest.Nearest(u, weights, kCount, view));
    const Clock::time_point middle = Clock::now();
    benchmark::DoNotOptimize(LookAtAll(designs, u));
    some += std::chrono::duration<double>(middle - begin).count();
    all += std::chrono::duration<double>(Clock::now() - middle).count();
  }
  state.counters["ratio"] = all / some;
  state.counters["us"] = 1e6 * some / static_cast<double>(state.iterations());
}

BENCHMARK(BM_NearestDesigns)
    ->ArgsProduct({{3, 30}, {1000, 30000}, {1, 2}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
