// What composing costs: snapping and connecting components of designs that ship, dragging a
// control, and reading the connections of all of them part by part. Beside connecting stands the
// parametrisation of what comes out, which is part of it.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "services/composer/model/controls.h"
#include "services/composer/snapping/snap.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

struct Composition {
  std::string body, body_node, from, node;
  Eigen::Vector3d middle;  // m, of the component, where it is dropped
};

const Composition& CompositionAt(std::int64_t index) {
  static const auto* const all = new std::vector<Composition>{
      {"cabinet", "case", "bookshelf", "shelf 3", {0.5, 0.2, 0.2}},
      {"tool_cart", "frame", "tool_cart", "drawer", {0.36, 0.22, 0.715}},
      {"dining_table", "frame", "workbench", "top", {0.8, 0.45, 0.75}},
      {"cabinet", "case", "cabinet", "left door", {0.26, -0.02, 0.31}}};
  return all->at(static_cast<std::size_t>(index));
}

struct Prepared {
  explicit Prepared(const Composition& of)
      : body(ShippedComponent(of.body, of.body_node)),
        dropped(DroppedAt(ShippedComponent(of.from, of.node), of.middle)),
        original(ShippedOriginal(of.from)),
        snapped(Snap(dropped, &original.design, body).value().component) {}

  Design body, dropped;
  Original original;
  Design snapped;
};

std::string NameOf(const Composition& of) { return of.node + " in " + of.body; }

void BM_Snap(benchmark::State& state) {
  const Prepared prepared(CompositionAt(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(Snap(prepared.dropped, &prepared.original.design, prepared.body));
  }
  state.SetLabel(NameOf(CompositionAt(state.range(0))));
}
BENCHMARK(BM_Snap)->DenseRange(0, 3)->Unit(benchmark::kMillisecond);

void BM_Connect(benchmark::State& state) {
  const Prepared prepared(CompositionAt(state.range(0)));
  const std::vector<const CollectionConnection*> all = AllShippedConnections();
  const ConnectOptions options = ShippedOptions();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        Connect(prepared.body, prepared.snapped, "new", &prepared.original, all, options));
  }
  state.SetLabel(NameOf(CompositionAt(state.range(0))));
}
BENCHMARK(BM_Connect)->DenseRange(0, 3)->Unit(benchmark::kMillisecond);

void BM_ParametriseWhatIsConnected(benchmark::State& state) {
  const Prepared prepared(CompositionAt(state.range(0)));
  const Connected made = Connect(prepared.body, prepared.snapped, "new", &prepared.original,
                                 AllShippedConnections(), ShippedOptions())
                             .value();
  for (auto _ : state) {
    benchmark::DoNotOptimize(AsDrawn(made.model.assembly->assembly()));
  }
  state.SetLabel(NameOf(CompositionAt(state.range(0))));
}
BENCHMARK(BM_ParametriseWhatIsConnected)->DenseRange(0, 3)->Unit(benchmark::kMillisecond);

void BM_Drag(benchmark::State& state) {
  const Design& cabinet = ShippedDesign("cabinet");
  double width = 1;
  for (auto _ : state) {
    width = width > 1.1 ? 1 : width + 0.005;
    benchmark::DoNotOptimize(Drag(cabinet, "", ControlKind::kSize, Axis::kX, width));
  }
  state.SetLabel("the width of a cabinet of 117 parts");
}
BENCHMARK(BM_Drag)->Unit(benchmark::kMillisecond);

void BM_ConnectionsOfWhatShips(benchmark::State& state) {
  for (const std::string& id : parametric::ShippedAssemblyIds()) ShippedDesign(id);
  std::size_t count = 0;
  for (auto _ : state) {
    count = 0;
    for (const std::string& id : parametric::ShippedAssemblyIds()) {
      count += ConnectionsOf(id, ShippedDesign(id).assembly->assembly()).value().size();
    }
  }
  state.counters["connections"] = static_cast<double>(count);
}
BENCHMARK(BM_ConnectionsOfWhatShips)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::composer

BENCHMARK_MAIN();
