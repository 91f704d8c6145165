// Importing drawings of round parts: reading them, searching them, and making them again of what
// the search came to, as the first look after a restart does. The argument is how many pins a board
// has; 0 is the bearing of seven round parts.
#include <benchmark/benchmark.h>

#include <string>
#include <utility>

#include "common/assembly/codec/assembly_codec.h"
#include "common/assembly/codec/parametrization_codec.h"
#include "common/assembly/trial/drawn_contacts.h"
#include "common/cad/step/step_reader.h"
#include "services/catalog/exchange/assembly_import.h"
#include "services/catalog/records/shape_records.h"
#include "tests/support/round_parts.h"

namespace mortise::catalog {
namespace {

constexpr int kBearing = 0;

std::string StepOf(int pins) {
  return pins == kBearing ? testing::BearingStep() : testing::PinBoardStep(pins);
}

v1::AssemblyBundle BundleOf(const std::string& step) {
  cad::StepAssembly drawing = cad::ReadStep(step).value();
  v1::AssemblyBundle bundle;
  for (mesh::DrawnShape& shape : drawing.shapes) {
    *bundle.add_shapes() = NamedShape(shape);
    shape.name = bundle.shapes(bundle.shapes_size() - 1).name();
  }
  v1::AssemblyAnnotations annotations;
  annotations.set_name("assemblies/round");
  *bundle.mutable_assembly() = MakeAssembly(drawing, annotations, {}).assembly;
  bundle.mutable_assembly()->set_digest(parametric::BundleDigest(bundle));
  return bundle;
}

bool IsNeverGivenUp() { return false; }

void BM_Read(benchmark::State& state) {
  const std::string step = StepOf(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(cad::ReadStep(step));
}
BENCHMARK(BM_Read)->Arg(kBearing)->Arg(58)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_Contacts(benchmark::State& state) {
  const v1::AssemblyBundle bundle = BundleOf(StepOf(static_cast<int>(state.range(0))));
  const parametric::ShapesByName shapes = parametric::FromProto(bundle.shapes()).value();
  const parametric::Assembly assembly =
      parametric::FromProto(bundle.assembly(), {}, shapes).value();
  for (auto _ : state) {
    const auto touching =
        parametric::FindTouchingParts(assembly, parametric::ToleranceOf(assembly));
    state.counters["contacts"] = static_cast<double>(touching->size());
  }
  state.counters["parts"] = static_cast<double>(assembly.parts.size());
}
BENCHMARK(BM_Contacts)->Arg(kBearing)->Arg(58)->Unit(benchmark::kMillisecond)->UseRealTime();

// All that is searched, or with what a search before came to.
void BM_Parametrize(benchmark::State& state) {
  const v1::AssemblyBundle bundle = BundleOf(StepOf(static_cast<int>(state.range(0))));
  const auto first = parametric::ParametrizeWith({}, bundle, IsNeverGivenUp, "");
  if (!first.ok()) return state.SkipWithError(std::string(first.status().message()).c_str());
  parametric::SearchOptions search;
  if (state.range(1) != 0) search.outcome = &(*first)->search_outcome();
  for (auto _ : state) {
    benchmark::DoNotOptimize(parametric::ParametrizeWith(search, bundle, IsNeverGivenUp, ""));
  }
  state.counters["degrees_of_freedom"] = (*first)->feasible_set().degrees_of_freedom();
}
BENCHMARK(BM_Parametrize)
    ->ArgNames({"pins", "known"})
    ->ArgsProduct({{kBearing, 58}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace mortise::catalog

BENCHMARK_MAIN();
