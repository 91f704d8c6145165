// What exact gradients cost: an evaluation of a stack of five boards, whose ten parameters are
// their widths and heights, without and with the gradients of compliance, largest displacement and
// mass by all of them. The argument is whether elements are quadratic.
#include <benchmark/benchmark.h>
#include <google/protobuf/text_format.h>

#include <memory>

#include "absl/strings/str_cat.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/simulator/worker/design_motion.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::simulator {
namespace {

constexpr int kBoards = 5;

std::shared_ptr<const templates::Template> Stack() {
  std::string parameters, parts, below = "0";
  for (int i = 0; i < kBoards; ++i) {
    for (const char* what : {"width", "height"}) {
      const double value = *what == 'w' ? 0.2 - 0.02 * i : 0.03;
      absl::StrAppend(&parameters, "parameters { name: '", what, i,
                      "' unit: 'm' minimum: ", 0.8 * value, " maximum: ", 1.04 * value,
                      " default_value: ", value, " } ");
    }
    const std::string above = absl::StrCat(below, " + height", i);
    absl::StrAppend(&parts, "parts { name: 'board", i,
                    "' item: 'items/spruce-planed-2400' length_axis: X thickness_axis: Z box { "
                    "x { from: '0' to: '0.4' } y { from: '-width",
                    i, " / 2' to: 'width", i, " / 2' } z { from: '", below, "' to: '", above,
                    "' } } } ");
    below = above;
  }
  v1::TemplateBundle bundle = templates::ShippedTemplate("");
  google::protobuf::TextFormat::ParseFromString(
      absl::StrCat("name: 'templates/stack' title: 'Stack' ", parameters, parts,
                   "boundary_conditions { name: 'foot' kind: FIXED part: 'board0' face: 'x_min' } "
                   "boundary_conditions { name: 'push' kind: FORCE part: 'board4' face: 'z_max' "
                   "components: '0' components: '0' components: '-1000' } "),
      bundle.mutable_template_());
  auto function = templates::Compile(bundle);
  return function.ok() ? *function : nullptr;
}

void Evaluating(benchmark::State& state, bool with_gradients) {
  const auto stack = Stack();
  if (stack == nullptr) return state.SkipWithError("no template");
  const Eigen::VectorXd q = parametric::Defaults(stack->parameters());
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.02;
  options.mesh.quadratic = state.range(0) != 0;
  for (auto unused : state) {
    const auto design = stack->Evaluate(q);
    if (!design.ok()) return state.SkipWithError("no design");
    const auto model = MakeDesignModel(*stack, q, *design);
    if (!model.ok()) return state.SkipWithError("no model");
    DesignMotion motion;
    if (with_gradients) motion = KnownMotion(*stack, q, *design, *model);
    options.motion = with_gradients ? &motion : nullptr;
    const auto analysis =
        AnalyzeDesign(*model, {"compliance", "max_displacement", "mass"}, false, options);
    if (!analysis.ok() || analysis->gradients.size() != (with_gradients ? 3 : 0)) {
      return state.SkipWithError("no analysis");
    }
    state.counters["elements"] = static_cast<double>(analysis->mesh->tetrahedra.cols());
  }
}
BENCHMARK_CAPTURE(Evaluating, alone, false)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Evaluating, with_gradients, true)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::simulator

BENCHMARK_MAIN();
