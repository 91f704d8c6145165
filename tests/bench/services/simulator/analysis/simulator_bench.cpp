// From surface to metrics for a table of nine parts, by element size and type.
#include <benchmark/benchmark.h>

#include "services/simulator/analysis/design_analysis.h"
#include "tests/unit/common/mesh/box_assembly.h"

namespace mortise::simulator {
namespace {

DesignModel LoadedTable() {
  DesignModel model;
  model.surface = mesh::TestTable();
  model.analysis.materials.assign(9, {"spruce", 450, 11e9, 0.3, 30e6});
  model.analysis.forces.push_back({{0, "z_max"}, {0, 0, -1000}});
  for (int leg = 1; leg <= 4; ++leg) model.analysis.supports.push_back({{leg, "z_min"}});
  return model;
}

// Arguments: element size in millimetres (0: the default), quadratic, radius-edge ratio × 10.
void BM_Table(benchmark::State& state) {
  const DesignModel model = LoadedTable();
  DesignAnalysisOptions options;
  options.mesh.element_size = 1e-3 * state.range(0);
  options.mesh.quadratic = state.range(1) != 0;
  options.mesh.radius_edge_ratio = 0.1 * state.range(2);
  DesignAnalysis last;
  for (auto unused : state) {
    last =
        *AnalyzeDesign(model, {"max_displacement", "compliance", "max_von_mises"}, false, options);
  }
  const ElasticitySummary& summary = last.cases[0].solution.summary;
  state.counters["elements"] = summary.elements;
  state.counters["unknowns"] = summary.solver.unknowns;
  state.counters["mesh_s"] = last.meshing_seconds;
  state.counters["assembly_s"] = summary.assembly_seconds;
  state.counters["analysis_s"] = summary.solver.analysis_seconds;
  state.counters["preparation_s"] = summary.solver.preparation_seconds;
  state.counters["recovery_s"] = summary.recovery_seconds;
  state.counters["deflection_mm"] = 1e3 * last.metrics[0].value;
  state.counters["compliance"] = last.metrics[1].value;
  state.counters["stress_MPa"] = 1e-6 * last.metrics[2].value;
}
BENCHMARK(BM_Table)
    ->Unit(benchmark::kMillisecond)
    ->Args({0, 1, 20})
    ->Args({0, 1, 30})
    ->Args({0, 1, 40})
    ->Args({0, 1, 60})
    ->Args({0, 0, 20})
    ->Args({30, 1, 20})
    ->Args({20, 1, 20});

// What heat and further load cases cost beside the first. Arguments: load cases; heat, and its
// stress.
void BM_WarmTable(benchmark::State& state) {
  DesignModel model = LoadedTable();
  for (Material& material : model.analysis.materials) {
    material.thermal_expansion = 5e-6;
    material.conductivity = 0.12;
  }
  for (int i = 1; i < state.range(0); ++i) {
    NamedLoadCase& load_case = model.load_cases.emplace_back();
    load_case.loads.gravity = {0, 0, -9.81 * i};
  }
  if (state.range(0) > 1) model.load_cases.emplace_back();
  if (state.range(1) != 0) {
    HeatCase& heat = model.heat.emplace();
    heat.materials = model.analysis.materials;
    heat.fluxes = {{{0, "z_max"}, 800}};
    heat.convections = {{{0, "z_min"}, 8, 293.15}};
    model.reference_temperature = 293.15;
  }
  DesignAnalysisOptions options;
  DesignAnalysis last;
  for (auto unused : state) last = *AnalyzeDesign(model, {"max_von_mises"}, false, options);
  state.counters["unknowns"] = last.cases[0].solution.summary.solver.unknowns;
  state.counters["mesh_s"] = last.meshing_seconds;
  state.counters["heat_s"] = last.heat ? last.heat->seconds : 0;
  state.counters["stress_MPa"] = 1e-6 * last.metrics[0].value;
}
BENCHMARK(BM_WarmTable)
    ->Unit(benchmark::kMillisecond)
    ->Args({1, 0})
    ->Args({1, 1})
    ->Args({2, 0})
    ->Args({5, 0})
    ->Args({5, 1});

}  // namespace
}  // namespace mortise::simulator

BENCHMARK_MAIN();
