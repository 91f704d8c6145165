// From parameters to a design where there is much of it: a shed of 1,333 pegs, and what checks of
// pegs against each other and against their parts take on import.
#include <benchmark/benchmark.h>

#include <string>

#include "common/design/evaluation.h"
#include "common/design/template_validation.h"
#include "tests/unit/common/design/varied_shelf.h"

namespace mortise::parametric {
namespace {

// Sixteen panels on beams, with 75 pegs each, and nineteen boards that lie on a beam with 7 pegs.
TemplateBundle Shed() {
  TemplateBundle bundle = VariedShelf();
  TemplateDefinition& shed = bundle.definition;
  shed.parameters = {Number("length", "m", 1.4, 1.6, 1.5)};
  shed.boundary_conditions.clear();
  shed.parts = {BoxPart("beam", {"0", "length"}, {"0", "0.5"}, {"0", "0.1"}),
                BoxPart("panel", {"0", "length"}, {"0", "0.5"}, {"0.1", "0.2"}),
                BoxPart("plate", {"0", "length"}, {"-9.5", "-0.1"}, {"0", "0.1"}),
                BoxPart("board", {"0", "length"}, {"-0.3", "-0.2"}, {"0.1", "0.2"})};
  shed.parts[2].length_axis = Axis::kY;
  shed.parts[0].repeat = {{"16", "", "0.6", ""}};
  shed.parts[1].repeat = {{"16", "", "0.6", ""}};
  shed.parts[3].repeat = {{"19", "", "-0.4", ""}};
  Connection panels = Pegs("panels", "panel", "z_min", "beam");
  panels.end_distance = 0.05;
  panels.spacing = 0.1;
  panels.row_spacing = 0.1;
  Connection boards = Pegs("boards", "board", "z_min", "plate");
  boards.end_distance = 0.05;
  boards.spacing = 0.25;
  shed.connections = {panels, boards};
  return bundle;
}

void EvaluateShed(benchmark::State& state) {
  const auto shed = TemplateFunction::Create(Shed());
  if (!shed.ok()) return state.SkipWithError("does not compile");
  std::size_t pegs = 0;
  for (auto unused : state) {
    const auto design = shed->Evaluate(shed->Defaults());
    if (!design.ok()) return state.SkipWithError("cannot be evaluated");
    pegs = design->connectors.size();
  }
  state.counters["pegs"] = static_cast<double>(pegs);
}
BENCHMARK(EvaluateShed)->Unit(benchmark::kMillisecond);

void ValidateShed(benchmark::State& state) {
  const TemplateBundle shed = Shed();
  for (auto unused : state) {
    if (!ValidateTemplate(shed).empty()) return state.SkipWithError("is not valid");
  }
}
BENCHMARK(ValidateShed)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::parametric

BENCHMARK_MAIN();
