// Parametrising a body to which a component comes, knowing both: beside it, what parametrising the
// whole without that takes, in the same run.
#include <benchmark/benchmark.h>

#include <ctime>
#include <string>
#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "tests/unit/common/assembly/bookcase.h"
#include "tests/unit/common/assembly/large_assemblies.h"

namespace mortise::parametric {
namespace {

// Bodies of about 50, 100, 200, 300 and 700 parts of furniture that stands side by side.
const std::vector<std::string>& BodyAt(std::int64_t index) {
  static const auto* const all = new std::vector<std::vector<std::string>>{
      {"bookshelf", "toy_chest", "coat_rack"},
      {"bookshelf", "dining_table", "toy_chest", "coat_rack"},
      {"bookshelf", "dining_table", "toy_chest", "workbench"},
      {"cabinet", "workbench", "bookshelf", "dining_table"},
      {"cabinet", "workbench", "bookshelf", "dining_table", "chicken_coop", "bed", "tool_cart",
       "bar_chair"}};
  return all->at(static_cast<std::size_t>(index));
}

// A toy chest beside the body, its parts as they are by themselves.
Assembly WithChest(const Assembly& body, const Assembly& chest) {
  Assembly both = body;
  const BoundingBox around = BoxAroundAll(body), box = BoxAroundAll(chest);
  AddShifted(chest, "chest",
             {around.maximum.x() - box.minimum.x(), around.maximum.y() - box.maximum.y(),
              around.minimum.z() - box.minimum.z()},
             &both);
  return both;
}

void AddAChest(benchmark::State& state, const Assembly& body) {
  const Assembly chest = ReadShippedAssembly("toy_chest").value();
  const Assembly both = WithChest(body, chest);
  const auto known = ParametricAssembly::Create(body), added = ParametricAssembly::Create(chest);
  if (!known.ok() || !added.ok()) return state.SkipWithError("not parametrised");
  const auto make = [&](const std::vector<const ParametricAssembly*>& of) {
    const std::clock_t begin = std::clock();
    const auto made = ParametricAssembly::Create(
        both, [] { return false; }, of);
    if (!made.ok()) state.SkipWithError("not parametrised");
    return static_cast<double>(std::clock() - begin);
  };
  make({});  // so that neither of the two is the first to touch memory
  double whole = 0, incremental = 0;
  for (auto _ : state) {
    incremental += make({&*known, &*added});
    state.PauseTiming();
    whole += make({});
    state.ResumeTiming();
  }
  state.counters["parts"] = static_cast<double>(both.parts.size());
  state.counters["of_whole"] = incremental / whole;
}

void BM_AddToFurniture(benchmark::State& state) {
  AddAChest(state, SideBySide(BodyAt(state.range(0))));
}
BENCHMARK(BM_AddToFurniture)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);

// To a body of as many columns of shelves, all in one group.
void BM_AddToBookcase(benchmark::State& state) {
  AddAChest(state, Bookcase(static_cast<int>(state.range(0)), 4));
}
BENCHMARK(BM_AddToBookcase)->Arg(10)->Arg(40)->Arg(90)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::parametric

BENCHMARK_MAIN();
