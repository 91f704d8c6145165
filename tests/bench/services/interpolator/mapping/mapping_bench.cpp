// How long it takes to bring the shape of one mesh into another's elements, by the number of
// tetrahedra: a plate with a hole mapped to one with a larger hole, and a bracket to one with
// another fillet. Counters: `triangles` of the target's surface, the share of the time that the
// surface takes, `inverted` elements that are left, `error` of the surface's nodes in cells of the
// source, and `against_linear`: how many times as long as in proportion to a tenth of the elements.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>

#include "services/interpolator/mapping/mesh_mapper.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Cells of which there are about as many tetrahedra, in proportion 10 : 3 : 1.
BlockCells CellsFor(double tetrahedra, int intervals, bool is_mirrored) {
  const double unit = std::cbrt(tetrahedra / 6 / (20 * 6 * 2));
  const auto cells = [unit](double of) { return std::max(2, static_cast<int>(of * unit)); };
  return {.along = std::max(2, cells(20) / intervals),
          .across = cells(6),
          .high = cells(2),
          .is_mirrored = is_mirrored,
          .unrest = 0.15};
}

struct Measured {
  double seconds = 0, surface_seconds = 0;
  double error = 0;
  int tetrahedra = 0, triangles = 0;
  std::size_t inverted = 0;
};

Measured MapOne(const BlockShape& from, const BlockShape& to, double tetrahedra) {
  const int intervals = static_cast<int>(from.knots.size()) - 1;
  const BlockMesh source = MakeBlockMesh(from, CellsFor(1.2 * tetrahedra, intervals, true));
  const BlockMesh target = MakeBlockMesh(to, CellsFor(tetrahedra, intervals, false));
  Measured measured;
  measured.tetrahedra = static_cast<int>(target.marked_mesh.mesh.tetrahedra.cols());
  measured.triangles = static_cast<int>(target.marked.surface.triangles.cols());
  auto start = Clock::now();
  benchmark::DoNotOptimize(MapSurface(source.marked, target.marked));
  measured.surface_seconds = SecondsSince(start);
  start = Clock::now();
  const auto mapper = MeshMapper::Create(ModelOf(target));
  if (!mapper.ok()) return {};
  const auto map = (*mapper)->Map(ModelOf(source));
  measured.seconds = SecondsSince(start);
  if (!map.ok()) return {};
  measured.inverted = map->volume.inverted.size();
  for (std::size_t v = 0; v < target.node.size(); ++v) {
    const Eigen::Vector3d known = from.image(target.block.col(target.node[v]));
    measured.error = std::max(
        measured.error, (map->surface.positions.col(static_cast<Eigen::Index>(v)) - known).norm());
  }
  measured.error /= source.cell_size;
  return measured;
}

void Run(benchmark::State& state, const BlockShape& from, const BlockShape& to) {
  const auto tetrahedra = static_cast<double>(state.range(0));
  Measured measured;
  for (auto _ : state) measured = MapOne(from, to, tetrahedra);
  if (measured.tetrahedra == 0) return state.SkipWithError("no map");
  const Measured tenth = MapOne(from, to, tetrahedra / 10);
  state.counters["tetrahedra"] = measured.tetrahedra;
  state.counters["triangles"] = measured.triangles;
  state.counters["seconds"] = measured.seconds;
  state.counters["surface_share"] = measured.surface_seconds / measured.seconds;
  state.counters["inverted"] = static_cast<double>(measured.inverted);
  state.counters["error"] = measured.error;
  state.counters["against_linear"] =
      measured.seconds / measured.tetrahedra / (tenth.seconds / tenth.tetrahedra);
}

void BM_Plate(benchmark::State& state) {
  Run(state, PlateShape(0.3, 0.2, 0.03, 0.06), PlateShape(0.3, 0.2, 0.03, 0.04));
}
BENCHMARK(BM_Plate)->Arg(5000)->Arg(50000)->Iterations(1)->Unit(benchmark::kSecond);

void BM_Bracket(benchmark::State& state) {
  Run(state, BracketShape(0.2, 0.03, 0.05, 0.1), BracketShape(0.2, 0.03, 0.02, 0.1));
}
BENCHMARK(BM_Bracket)->Arg(5000)->Arg(50000)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace mortise::interpolator

BENCHMARK_MAIN();
