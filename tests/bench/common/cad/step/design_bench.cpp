// How long a design takes from parameters to parts, to a conforming surface, and to files.
#include <benchmark/benchmark.h>

#include "common/cad/step/step_writer.h"
#include "common/cad/surface/assembly_surface.h"
#include "common/design/part_shapes.h"
#include "common/design/template_validation.h"
#include "tests/unit/common/files/table.h"

namespace mortise {
namespace {

parametric::TemplateFunction Table() {
  return *parametric::TemplateFunction::Create(parametric::TableBundle());
}

void EvaluateTable(benchmark::State& state) {
  const auto table = Table();
  const Eigen::VectorXd q = table.Defaults();
  for (auto _ : state) benchmark::DoNotOptimize(table.Evaluate(q));
}
BENCHMARK(EvaluateTable);

void EvaluateTableMassGradient(benchmark::State& state) {
  const auto table = Table();
  const Eigen::VectorXd q = table.Defaults();
  for (auto _ : state) benchmark::DoNotOptimize(table.EvaluateMass(q));
}
BENCHMARK(EvaluateTableMassGradient);

void ValidateTable(benchmark::State& state) {
  const auto bundle = parametric::TableBundle();
  for (auto _ : state) benchmark::DoNotOptimize(parametric::ValidateTemplate(bundle));
}
BENCHMARK(ValidateTable)->Unit(benchmark::kMillisecond);

void FuseTable(benchmark::State& state) {
  const auto table = Table();
  const auto shapes = parametric::PartShapes(*table.Evaluate(table.Defaults()));
  for (auto _ : state) benchmark::DoNotOptimize(cad::FuseAssembly(shapes));
}
BENCHMARK(FuseTable)->Unit(benchmark::kMillisecond);

void WriteTableAsStep(benchmark::State& state) {
  const auto table = Table();
  std::vector<cad::AssemblyPart> parts;
  for (const auto& shape : parametric::PartShapes(*table.Evaluate(table.Defaults()))) {
    parts.push_back({*cad::Solid::FromPart(shape), {0.8, 0.6, 0.4}});
  }
  for (auto _ : state) benchmark::DoNotOptimize(cad::WriteStep("table", parts));
}
BENCHMARK(WriteTableAsStep)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise

BENCHMARK_MAIN();
