// The interactive setting: about 10,000 quadratic tetrahedra from the features of a template to its
// stresses, and again with other parameters, as while somebody drags a slider.
#include <benchmark/benchmark.h>

#include <chrono>
#include <memory>

#include "common/base/elapsed_time.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kThreads = 2;

// The parameters at a share of the way from their defaults to their ends.
Eigen::VectorXd Dragged(const templates::Template& function, double share) {
  Eigen::VectorXd q = parametric::Defaults(function.parameters());
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const parametric::Parameter& parameter = function.parameters()[static_cast<std::size_t>(k)];
    q[k] += share * (parameter.maximum - q[k]);
  }
  return q;
}

// Arguments: the size of elements, in tenths of a millimetre; the solver.
void Dragging(benchmark::State& state, const std::string& name) {
  const auto function = templates::Compile(templates::ShippedTemplate("templates/" + name));
  if (!function.ok()) return state.SkipWithError("no template");
  DesignAnalysisOptions options;
  options.mesh.element_size = 1e-4 * static_cast<double>(state.range(0));
  options.elasticity.threads = kThreads;
  options.elasticity.solver.kind = static_cast<SolverKind>(state.range(1));
  double share = 0;
  for (auto unused : state) {
    const auto start = Clock::now();
    const Eigen::VectorXd q = Dragged(**function, share);
    share += 0.01;
    const auto design = (*function)->Evaluate(q);
    if (!design.ok()) return state.SkipWithError("no design");
    const auto model =
        MakeDesignModel(**function, q, *design, {.element_size = options.mesh.element_size});
    if (!model.ok()) return state.SkipWithError("no model");
    state.counters["geometry_s"] = SecondsSince(start);
    const auto analysis = AnalyzeDesign(*model, {"max_von_mises"}, false, options);
    if (!analysis.ok()) {
      return state.SkipWithError(std::string(analysis.status().message()).c_str());
    }
    const ElasticitySummary& summary = analysis->cases[0].solution.summary;
    state.counters["elements"] = summary.elements;
    state.counters["unknowns"] = summary.solver.unknowns;
    state.counters["mesh_s"] = analysis->meshing_seconds;
    state.counters["assembly_s"] = summary.assembly_seconds;
    state.counters["analysis_s"] = summary.solver.analysis_seconds;
    state.counters["preparation_s"] = summary.solver.preparation_seconds;
    state.counters["solution_s"] = summary.solver.solution_seconds;
    state.counters["recovery_s"] = summary.recovery_seconds;
    state.counters["iterations"] = summary.solver.iterations;
    state.counters["direct"] = summary.solver.kind == SolverKind::kDirect;
  }
}
constexpr auto kDirect = static_cast<int64_t>(SolverKind::kDirect);
constexpr auto kIterative = static_cast<int64_t>(SolverKind::kIterative);
BENCHMARK_CAPTURE(Dragging, wrench, "wrench")
    ->ArgNames({"size", "solver"})
    ->ArgsProduct({{40}, {kDirect, kIterative}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Dragging, camera_mount, "camera-mount")
    ->ArgNames({"size", "solver"})
    ->ArgsProduct({{40}, {kDirect, kIterative}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Dragging, table, "table")
    ->ArgNames({"size", "solver"})
    ->ArgsProduct({{500}, {kDirect, kIterative}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::simulator

BENCHMARK_MAIN();
