// How long the CAD templates that ship take from parameters to a checked solid, and to triangles;
// and how many of 200 random designs of each are no valid solids.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <random>
#include <string>

#include "common/cad/cad_template_codec.h"
#include "common/cad/feature_model.h"
#include "common/cad/solid_surface.h"

namespace mortise::cad {
namespace {

std::vector<FeatureModel> ShippedModels() {
  const char* root = std::getenv("MORTISE_SOURCE_DIR");
  std::vector<FeatureModel> models;
  const auto definitions =
      ReadCadTemplates(std::string(root == nullptr ? "." : root) + "/collection/cad_templates");
  if (!definitions.ok()) return models;
  for (const CadTemplate& definition : *definitions) {
    auto model = FeatureModel::Create(definition);
    if (model.ok()) models.push_back(*std::move(model));
  }
  return models;
}

void Regenerate(benchmark::State& state, const FeatureModel& model) {
  for (auto _ : state) {
    const auto solid = model.Regenerate(model.Defaults());
    if (!solid.ok()) return state.SkipWithError(std::string(solid.status().message()).c_str());
  }
}

// 200 designs all over the parameter box, and how many of them are no valid solids.
void RandomDesigns(benchmark::State& state, const FeatureModel& model) {
  constexpr int kDesigns = 200;
  const auto& parameters = model.definition().parameters;
  for (auto _ : state) {
    std::mt19937_64 random(2026);
    int invalid = 0;
    for (int k = 0; k < kDesigns; ++k) {
      Eigen::VectorXd q = model.Defaults();
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        const auto& parameter = parameters[static_cast<std::size_t>(i)];
        const double t = static_cast<double>(random() >> 11) * 0x1p-53;
        q(i) = (1 - t) * parameter.minimum + t * parameter.maximum;
      }
      if (!model.Regenerate(q).ok()) ++invalid;
    }
    state.counters["designs"] = kDesigns;
    state.counters["invalid"] = invalid;
  }
}

void Triangulate(benchmark::State& state, const FeatureModel& model) {
  const auto solid = model.Regenerate(model.Defaults());
  if (!solid.ok()) return state.SkipWithError(std::string(solid.status().message()).c_str());
  for (auto _ : state) benchmark::DoNotOptimize(SurfaceOf(solid->solid));
}

void Validate(benchmark::State& state, const FeatureModel& model) {
  for (auto _ : state) benchmark::DoNotOptimize(ValidateCadTemplate(model.definition()));
}

void RegisterAll() {
  for (const FeatureModel& model : ShippedModels()) {
    const std::string& name = model.definition().name;
    const auto add = [&](const std::string& what, auto* function) {
      benchmark::RegisterBenchmark((what + name).c_str(), function, model)
          ->Unit(benchmark::kMillisecond);
    };
    add("Regenerate ", &Regenerate);
    add("Triangulate ", &Triangulate);
    add("Validate ", &Validate);
    benchmark::RegisterBenchmark(("RandomDesigns " + name).c_str(), &RandomDesigns, model)
        ->Unit(benchmark::kSecond)
        ->Iterations(1);
  }
}

}  // namespace
}  // namespace mortise::cad

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  mortise::cad::RegisterAll();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
