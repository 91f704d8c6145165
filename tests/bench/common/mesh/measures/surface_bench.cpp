// What it costs to know what lies beside what on a surface of 100,000 triangles, and what is made
// of it: checks, pictures and repair, each also as a ratio to sorting the edges of all triangles,
// which is the least that any of them could do.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <random>
#include <utility>
#include <vector>

#include "common/mesh/halfedge_mesh.h"
#include "common/mesh/measures/silhouette.h"
#include "common/mesh/repair/surface_repair.h"
#include "common/mesh/surface_check.h"
#include "common/render/feature_edges.h"
#include "tests/unit/common/mesh/round_solids.h"

namespace mortise::mesh {
namespace {

// A torus whose triangles lie in no order.
SurfaceMesh Shuffled() {
  SurfaceMesh torus = Torus(0.1, 0.03, 224);
  std::vector<int> order(static_cast<std::size_t>(torus.triangles.cols()));
  for (std::size_t t = 0; t < order.size(); ++t) order[t] = static_cast<int>(t);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(1));
  torus.triangles = torus.triangles(Eigen::all, order).eval();
  return torus;
}

// Every triangle with corners of its own.
SurfaceMesh Loose(const SurfaceMesh& surface) {
  SurfaceMesh loose{surface.vertices(Eigen::all, surface.triangles.reshaped()), surface.triangles};
  for (int i = 0; i < static_cast<int>(loose.triangles.size()); ++i) loose.triangles(i) = i;
  return loose;
}

void SortEdges(const SurfaceMesh& surface) {
  std::vector<std::array<int, 3>> edges;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] =
          std::minmax(surface.triangles(k, t), surface.triangles((k + 1) % 3, t));
      edges.push_back({low, high, static_cast<int>(t)});
    }
  }
  std::sort(edges.begin(), edges.end());
  benchmark::DoNotOptimize(edges.data());
}

// Runs `work` on a surface; beside its time stands how many times that of sorting it is.
template <typename Work>
void Compare(benchmark::State& state, const SurfaceMesh& surface, const Work& work) {
  using Clock = std::chrono::steady_clock;
  Clock::duration sorting{}, working{};
  for (auto unused : state) {
    const auto start = Clock::now();
    SortEdges(surface);
    const auto middle = Clock::now();
    if (!work(surface)) return state.SkipWithError("not what it should be");
    const auto end = Clock::now();
    sorting += middle - start;
    working += end - middle;
    state.SetIterationTime(std::chrono::duration<double>(end - middle).count());
  }
  state.counters["triangles"] = static_cast<double>(surface.triangles.cols());
  state.counters["of_sorting"] =
      static_cast<double>(working.count()) / static_cast<double>(sorting.count());
}

void BM_HalfedgeMesh(benchmark::State& state) {
  Compare(state, Shuffled(), [](const SurfaceMesh& surface) {
    return CutSurface(surface.vertices, surface.triangles).mesh().n_faces() > 0;
  });
}
BENCHMARK(BM_HalfedgeMesh)->UseManualTime()->Unit(benchmark::kMillisecond);

void BM_CheckSurface(benchmark::State& state) {
  Compare(state, Shuffled(),
          [](const SurfaceMesh& surface) { return CheckSurface(surface).empty(); });
}
BENCHMARK(BM_CheckSurface)->UseManualTime()->Unit(benchmark::kMillisecond);

void BM_FeatureEdges(benchmark::State& state) {
  Compare(state, Shuffled(), [](const SurfaceMesh& surface) {
    const auto edges = render::FindFeatureEdges(
        surface.vertices, surface.triangles, 0.5,
        [](const Eigen::Vector3d&, const Eigen::Vector3d& normal) { return normal.z() > 0; });
    return !edges.empty();
  });
}
BENCHMARK(BM_FeatureEdges)->UseManualTime()->Unit(benchmark::kMillisecond);

void BM_ProjectedArea(benchmark::State& state) {
  Compare(state, Shuffled(), [](const SurfaceMesh& surface) {
    return ProjectedArea({&surface, 1}, {0.1, 0.2, 1}) > 0;
  });
}
BENCHMARK(BM_ProjectedArea)->UseManualTime()->Unit(benchmark::kMillisecond);

// An upload of the most triangles that a shape may have, all of them loose.
void BM_RepairLooseTriangles(benchmark::State& state) {
  Compare(state, Loose(Torus(0.1, 0.03, 158)),
          [](const SurfaceMesh& surface) { return RepairSurface(surface).ok(); });
}
BENCHMARK(BM_RepairLooseTriangles)->UseManualTime()->Unit(benchmark::kMillisecond);

// The same, a twentieth of them turned over and every thousandth missing.
void BM_RepairTornSurface(benchmark::State& state) {
  SurfaceMesh torn = Torus(0.1, 0.03, 158);
  std::vector<int> left;
  for (int t = 0; t < static_cast<int>(torn.triangles.cols()); ++t) {
    if (t % 20 == 0) std::swap(torn.triangles(0, t), torn.triangles(1, t));
    if (t % 1000 != 17) left.push_back(t);
  }
  torn.triangles = torn.triangles(Eigen::all, left).eval();
  Compare(state, torn, [](const SurfaceMesh& surface) { return RepairSurface(surface).ok(); });
}
BENCHMARK(BM_RepairTornSurface)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::mesh

BENCHMARK_MAIN();
