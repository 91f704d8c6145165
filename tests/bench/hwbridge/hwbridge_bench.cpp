// What the handshake costs beside the cut itself: the journal's flush to disk, and a scan.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "hwbridge/cutting/journal.h"
#include "hwbridge/cutting/machine_worker.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

void BM_JournalAddCut(benchmark::State& state) {
  TemporaryFolder folder;
  auto journal = *Journal::Open(folder.path() / "journal", {.flush = state.range(0) != 0});
  std::int64_t sequence = 0;
  for (auto step : state) {
    ++sequence;
    benchmark::DoNotOptimize(
        journal->AddCut({{"workOrders/a", "saw", sequence}, CrosscutJob("leg", 0.5, 0.5)}));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_JournalAddCut)->ArgName("flush")->Arg(0)->Arg(1)->UseRealTime();

void BM_JournalOpen(benchmark::State& state) {
  TemporaryFolder folder;
  const auto path = folder.path() / "journal";
  {
    auto journal = *Journal::Open(path, {.flush = false});
    for (std::int64_t i = 1; i <= state.range(0); ++i) {
      (void)journal->AddCut({{"workOrders/a", "saw", i}, CrosscutJob("leg", 0.5, 0.5)});
    }
  }
  for (auto step : state) benchmark::DoNotOptimize(Journal::Open(path, {.flush = false}));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_JournalOpen)->Arg(10000)->Unit(benchmark::kMillisecond);

// A work order of 20 crosscuts without waiting: scans a second, machine included.
void BM_WorkerScan(benchmark::State& state) {
  TemporaryFolder folder;
  SimulatedPlant plant(MachineKind::kChopSaw);
  SimulatedLink link(plant);
  auto journal = *Journal::Open(folder.path() / "journal", {.flush = false});
  MachineWorker::Options options;
  options.name = "saw";
  MachineWorker worker(options, link, *journal, plant);
  for (std::int64_t i = 1; i <= 20; ++i) {
    (void)journal->AddCut({{"workOrders/a", "saw", i}, CrosscutJob("leg", 0.3 * i, 0.3)});
  }
  for (auto step : state) {
    worker.Cycle();
    plant.Advance(0.05);
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_WorkerScan);

}  // namespace
}  // namespace mortise::hwbridge

BENCHMARK_MAIN();
