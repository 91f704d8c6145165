// How long every template that ships takes: to compile, which happens once a revision, and from
// parameters to a design, which happens at every move of a slider.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::templates {
namespace {

void Compiling(benchmark::State& state, const v1::TemplateBundle& bundle) {
  for (auto _ : state) {
    if (!Compile(bundle).ok()) return state.SkipWithError("does not compile");
  }
}

void Evaluating(benchmark::State& state, const std::shared_ptr<const Template>& compiled) {
  Eigen::VectorXd q = parametric::Defaults(compiled->parameters());
  Eigen::Index number = 0;  // the first parameter that is no whole number
  while (number + 1 < q.size() &&
         parametric::IsWhole(compiled->parameters()[static_cast<std::size_t>(number)])) {
    ++number;
  }
  const parametric::Parameter& first = compiled->parameters()[static_cast<std::size_t>(number)];
  double sign = 1;
  for (auto _ : state) {
    // Another point each time, near enough to the defaults that the design can be made.
    double& value = q(number);
    value = first.default_value;
    const double room = sign > 0 ? first.maximum - value : value - first.minimum;
    value += sign * 0.01 * room;
    sign = -sign;
    benchmark::DoNotOptimize(compiled->Evaluate(q).ok());
  }
}

void Add(v1::TemplateBundle bundle) {
  if (!FillAndCheck(bundle, Trial::kDefaults).ok()) return;
  const auto compiled = Compile(bundle);
  if (!compiled.ok()) return;
  const std::string name = bundle.template_().name();
  benchmark::RegisterBenchmark(("compile/" + name).c_str(), Compiling, bundle)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark(("evaluate/" + name).c_str(), Evaluating, *compiled)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace mortise::templates

int main(int argc, char** argv) {
  namespace templates = mortise::templates;
  benchmark::Initialize(&argc, argv);
  for (const auto& message : templates::ShippedCollection().templates) {
    if (!message.has_assembly()) templates::Add(templates::ShippedTemplate(message.name()));
  }
  for (const auto& message : templates::ShippedCollection().assemblies) {
    templates::Add(templates::ShippedAssembly(message.name()));
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
