// What connections cost: finding them in shelves of growing size, placing one for other principals,
// and dragging the whole; beside it the graph of what touches, which they are found in.
#include <benchmark/benchmark.h>

#include <string>
#include <utility>

#include "common/assembly/connections/connection_optimizer.h"
#include "common/assembly/model/linear_design.h"
#include "common/assembly/parametric_assembly.h"
#include "common/mesh/repair/proximity.h"

namespace mortise::parametric {
namespace {

AssemblyPart Board(const std::string& name, const Eigen::Vector3d& minimum,
                   const Eigen::Vector3d& maximum) {
  AssemblyPart part;
  part.name = name;
  part.item = "items/board";
  part.box = {minimum, maximum};
  for (int axis = 0; axis < 3; ++axis) {
    const double size = maximum[axis] - minimum[axis];
    part.limits[static_cast<std::size_t>(axis)] = {size / 2, 2 * size};
  }
  return part;
}

AssemblyPart Screw(const std::string& name, const Eigen::Vector3d& minimum) {
  AssemblyPart part = Board(name, minimum, minimum + Eigen::Vector3d(0.04, 0.004, 0.004));
  part.item = "items/screw";
  part.connecting = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = part.box.size()[axis];
    part.limits[static_cast<std::size_t>(axis)] = {size, size};
  }
  return part;
}

// Two sides with boards at unequal heights, each screwed at both ends, three screws in an unequal
// row: 7 parts a board, none of them in a pattern.
Assembly Shelf(int parts) {
  Assembly shelf;
  shelf.name = "shelf";
  shelf.groups = {{"shelf", -1}};
  const int boards = (parts - 2) / 7;
  const double height = 0.02 * boards * boards + 0.11 * boards + 0.2;
  shelf.parts = {Board("left", {0, 0, 0}, {0.02, 0.3, height}),
                 Board("right", {0.98, 0, 0}, {1, 0.3, height})};
  for (int board = 0; board < boards; ++board) {
    const double z = 0.02 * board * board + 0.11 * board + 0.05;
    const std::string name = "board " + std::to_string(board);
    shelf.parts.push_back(Board(name, {0.02, 0, z}, {0.98, 0.3, z + 0.02}));
    for (int screw = 0; screw < 3; ++screw) {
      const double y = 0.02 + 0.06 * screw + 0.02 * screw * screw;
      const std::string number = " screw " + std::to_string(screw);
      shelf.parts.push_back(Screw(name + " left" + number, {0, y, z + 0.008}));
      shelf.parts.push_back(Screw(name + " right" + number, {0.96, y, z + 0.008}));
    }
  }
  return shelf;
}

void BM_Proximity(benchmark::State& state) {
  const Assembly shelf = Shelf(static_cast<int>(state.range(0)));
  std::vector<mesh::SurfaceMesh> surfaces;
  for (const AssemblyPart& part : shelf.parts) surfaces.push_back(SurfaceOf(part.box));
  std::size_t edges = 0;
  for (auto _ : state) edges = mesh::FindProximities(surfaces, 1e-6)->size();
  state.counters["parts"] = static_cast<double>(shelf.parts.size());
  state.counters["edges"] = static_cast<double>(edges);
}
BENCHMARK(BM_Proximity)->Arg(50)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);

void BM_FindConnections(benchmark::State& state) {
  const auto shelf = ParametricAssembly::Create(Shelf(static_cast<int>(state.range(0))));
  if (!shelf.ok()) return state.SkipWithError(shelf.status().ToString().c_str());
  for (auto _ : state) {
    benchmark::DoNotOptimize(FindConnections(shelf->assembly(), shelf->elements(),
                                             shelf->contacts(), shelf->relationships(),
                                             shelf->tolerance()));
  }
  state.counters["connections"] = static_cast<double>(shelf->connections().size());
}
BENCHMARK(BM_FindConnections)->Arg(50)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);

// A board and a side with three screws, for boards of changing depth and thickness.
void BM_OptimizeConnection(benchmark::State& state) {
  const auto shelf = ParametricAssembly::Create(Shelf(9));
  if (!shelf.ok()) return state.SkipWithError(shelf.status().ToString().c_str());
  const ConnectionOptimizer optimizer(shelf->connections().front());
  std::vector<BoundingBox> principals;
  for (const int element : optimizer.connection().principals) {
    principals.push_back(BoxOf(shelf->drawn(), element));
  }
  std::size_t i = 0;
  for (auto _ : state) {
    std::vector<BoundingBox> changed = principals;
    for (BoundingBox& box : changed) box.maximum.y() += 1e-3 * static_cast<double>(++i % 100);
    if (!optimizer.Optimize(changed).ok()) state.SkipWithError("not placed");
  }
  state.counters["degrees_of_freedom"] = optimizer.degrees_of_freedom();
}
BENCHMARK(BM_OptimizeConnection)->Unit(benchmark::kMicrosecond);

// A slider that is dragged: each design starts from the last.
void BM_Drag(benchmark::State& state) {
  const auto shelf = ParametricAssembly::Create(Shelf(static_cast<int>(state.range(0))));
  if (!shelf.ok()) return state.SkipWithError(shelf.status().ToString().c_str());
  Eigen::VectorXd q = shelf->drawn();
  std::size_t i = 0;
  for (auto _ : state) {
    const double depth = 0.3 + 1e-3 * static_cast<double>(++i % 100);
    auto dragged = shelf->Adjust(q, {{{"left", Axis::kY}, depth}}, DemandPolicy::kNearest);
    if (!dragged.ok()) state.SkipWithError("not found");
    q = std::move(dragged->q);
  }
  state.counters["degrees_of_freedom"] = shelf->feasible_set().degrees_of_freedom();
}
BENCHMARK(BM_Drag)->Arg(50)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::parametric

BENCHMARK_MAIN();
