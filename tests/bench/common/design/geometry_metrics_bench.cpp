// Metrics of the shape alone, in real time: all of them together, and the costly ones by
// themselves, of every template that ships, from an evaluated design on.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::simulator {
namespace {

struct Subject {
  std::shared_ptr<const templates::Template> function;
  Eigen::VectorXd parameters;
  parametric::EvaluatedDesign design;
};

void Evaluating(benchmark::State& state, const Subject& subject,
                const std::vector<std::string>& metrics) {
  DesignAnalysisOptions options;
  options.leave_out_inapplicable = true;
  Eigen::Index triangles = 0;
  for (auto unused : state) {
    const auto model = MakeDesignModel(*subject.function, subject.parameters, subject.design,
                                       {.is_wanted = false});
    if (!model.ok()) return state.SkipWithError("no model");
    benchmark::DoNotOptimize(AnalyzeDesign(*model, metrics, false, options).ok());
    triangles = 0;
    for (const SolidPart& part : model->parts) triangles += part.surface.triangles.cols();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}

void Add(v1::TemplateBundle bundle) {
  if (!templates::FillAndCheck(bundle, templates::Trial::kDefaults).ok()) return;
  const auto function = templates::Compile(bundle);
  if (!function.ok()) return;
  const Eigen::VectorXd q = parametric::Defaults((*function)->parameters());
  const auto design = (*function)->Evaluate(q);
  if (!design.ok()) return;
  std::vector<std::string> all;
  for (const MetricDescription& metric : GeometryMetrics::Offered()) all.push_back(metric.name);
  const std::vector<std::pair<std::string, std::vector<std::string>>> groups{
      {"all", all},
      {"inertia", {"mass", "center_of_mass_x", "inertia_xx"}},
      {"silhouette", {"projected_area_x"}},
      {"standing", {"toppling_margin"}},
      {"floating", {"draught"}}};
  for (const auto& [group, metrics] : groups) {
    benchmark::RegisterBenchmark((group + "/" + bundle.template_().name()).c_str(), Evaluating,
                                 Subject{*function, q, *design}, metrics)
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace
}  // namespace mortise::simulator

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  for (const auto& message : mortise::templates::ShippedCollection().templates) {
    mortise::simulator::Add(mortise::templates::ShippedTemplate(message.name()));
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
