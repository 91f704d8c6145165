// How long planning takes, and how near layouts come to their lower bounds.
#include <benchmark/benchmark.h>

#include <random>

#include "services/fabplanner/cutting/cutting_stock.h"
#include "services/fabplanner/cutting/sheet_layout.h"
#include "services/fabplanner/documents/assembly_picture.h"
#include "services/fabplanner/planning/planning.h"
#include "services/fabplanner/shop_floor/work_order.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

// Parts of 0.2 m to 1.2 m from boards of 2.4 m.
void CutRandomParts(benchmark::State& state) {
  std::mt19937 random(1);
  std::vector<CrosscutPart> parts(state.range(0));
  for (CrosscutPart& part : parts) {
    part = {"p", 0.2 + 1.0 * static_cast<double>(random() % 1000) / 1000};
  }
  CuttingStock cut;
  for (auto _ : state) cut = CutStock(parts, {{2.4}}).value();
  state.counters["boards"] = static_cast<double>(cut.boards.size());
  state.counters["over_bound"] = cut.cost / cut.lower_bound;
}
BENCHMARK(CutRandomParts)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);

// Rails of frames, mitred at 45°, or with ends of any angle up to that, from boards of 2.4 m.
void CutSlopedParts(benchmark::State& state) {
  std::mt19937 random(3);
  const auto fraction = [&] { return static_cast<double>(random() % 1000) / 1000; };
  std::vector<CrosscutPart> parts(state.range(0)), rectangles;
  for (CrosscutPart& part : parts) {
    part = {"p", 0.2 + 0.6 * fraction(), {{1, 0}, {-1, 0}}};
    if (state.range(1) != 0) part.ends = {{2 * fraction() - 1, 0}, {2 * fraction() - 1, 0}};
    rectangles.push_back({part.label, part.length});
  }
  const CuttingStockOptions options = {.section = {0.06, 0.03}};
  CuttingStock cut;
  for (auto _ : state) cut = CutStock(parts, {{2.4}}, options).value();
  state.counters["boards"] = static_cast<double>(cut.boards.size());
  state.counters["over_bound"] = cut.cost / cut.lower_bound;
  state.counters["of_rectangles"] = cut.cost / CutStock(rectangles, {{2.4}}, options)->cost;
}
BENCHMARK(CutSlopedParts)
    ->Args({10, 0})
    ->Args({100, 0})
    ->Args({1000, 0})
    ->Args({10, 1})
    ->Args({100, 1})
    ->Args({1000, 1})
    ->Unit(benchmark::kMillisecond);

// Rectangles of 0.1 m to 0.8 m on sheets of 2.44 m × 1.22 m.
void LayOutRandomSheets(benchmark::State& state) {
  std::mt19937 random(2);
  std::vector<SheetOutline> outlines(state.range(0));
  double area = 0;
  for (SheetOutline& outline : outlines) {
    const double length = 0.1 + 0.7 * static_cast<double>(random() % 1000) / 1000;
    const double width = 0.1 + 0.7 * static_cast<double>(random() % 1000) / 1000;
    outline = {"p", {{0, 0}, {length, 0}, {length, width}, {0, width}}};
    area += length * width;
  }
  std::size_t sheets = 0;
  for (auto _ : state) sheets = LayOutSheets(outlines, {2.44, 1.22}).value().size();
  state.counters["sheets"] = static_cast<double>(sheets);
  state.counters["over_area"] = static_cast<double>(sheets) * 2.44 * 1.22 / area;
}
BENCHMARK(LayOutRandomSheets)->Arg(20)->Arg(200)->Unit(benchmark::kMillisecond);

void PlanTables(benchmark::State& state) {
  const Design design = ExampleTable();
  const Items items = ExampleItems();
  for (auto _ : state) {
    benchmark::DoNotOptimize(MakePlan(design, items, static_cast<int>(state.range(0))));
  }
}
BENCHMARK(PlanTables)->Arg(1)->Arg(1000)->Unit(benchmark::kMillisecond);

void DrawTopStep(benchmark::State& state) {
  const Design design = ExampleTable();
  const auto steps = MakePlan(design, ExampleItems(), 1)->steps;
  for (auto _ : state) {
    benchmark::DoNotOptimize(DrawStep(ArrangeStep(design, ExampleItems(), {}, steps, 3)));
  }
}
BENCHMARK(DrawTopStep)->Unit(benchmark::kMillisecond);

// A report that ends a cut and gives out the next board, in an order of many cuts.
void ReportCuts(benchmark::State& state) {
  const auto plan = MakePlan(ExampleTable(), ExampleItems(), static_cast<int>(state.range(0)));
  const std::vector<Cut> cuts = CutsFor(*plan);
  const std::vector<MachineAddress> machines = {{"b", "saw", MachineKind::kChopSaw},
                                                {"b", "jigsaw", MachineKind::kJigsaw}};
  for (auto _ : state) {
    WorkOrder order(cuts);
    std::vector<int> sent = order.GiveOut(machines);
    for (std::size_t i = 0; i < sent.size(); ++i) {
      const Cut cut = order.cuts()[sent[i]];
      order.Report("b", {cut.machine, cut.sequence, CutOutcome::kDone, "", 1});
      for (int next : order.GiveOut(machines)) sent.push_back(next);
    }
    if (order.state() != OrderState::kCompleted) state.SkipWithError("not completed");
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(cuts.size()));
}
BENCHMARK(ReportCuts)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::fabplanner

BENCHMARK_MAIN();
