// How long the CAD templates that ship take from parameters to a checked solid, and to triangles;
// and how many of 200 random designs of each are no valid solids. Fails where any is not, or where
// a template does not compile.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <random>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/cad/solid_surface.h"
#include "common/templates/features/codec/cad_template_codec.h"
#include "common/templates/features/feature_model.h"

namespace mortise::cad {
namespace {

absl::StatusOr<std::vector<FeatureModel>> ShippedModels() {
  const char* root = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path folder =
      std::filesystem::path(root == nullptr ? "." : root) / "collection/cad_templates";
  std::error_code error;
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    files.insert(entry.path());
  }
  if (error) return ResourceNotFound(folder.string());
  std::vector<FeatureModel> models;
  for (const std::filesystem::path& file : files) {
    MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file));
    MORTISE_ASSIGN_OR_RETURN(const CadTemplate definition,
                             ParseCadTemplateText(text, file.filename().string()));
    MORTISE_ASSIGN_OR_RETURN(FeatureModel model, FeatureModel::Create(definition));
    models.push_back(std::move(model));
  }
  return models;
}

// A bench cannot go on without the design; what it would print would be of another.
RegeneratedModel DefaultOf(const FeatureModel& model) {
  absl::StatusOr<RegeneratedModel> solid = model.Regenerate(model.Defaults());
  if (solid.ok()) return *std::move(solid);
  std::cerr << model.definition().name << ": " << solid.status() << '\n';
  std::exit(1);
}

void Regenerate(benchmark::State& state, const FeatureModel& model) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(DefaultOf(model));
  }
}

// 200 designs all over the parameter box, and how many of them are no valid solids.
void RandomDesigns(benchmark::State& state, const FeatureModel& model, int* invalid_designs) {
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
    *invalid_designs += invalid;
  }
}

void Triangulate(benchmark::State& state, const FeatureModel& model) {
  const RegeneratedModel design = DefaultOf(model);
  for (auto _ : state) benchmark::DoNotOptimize(SurfaceOf(design.solid));
}

void Validate(benchmark::State& state, const FeatureModel& model) {
  for (auto _ : state) benchmark::DoNotOptimize(ValidateCadTemplate(model.definition()));
}

void Register(const std::vector<FeatureModel>& models, int* invalid_designs) {
  for (const FeatureModel& model : models) {
    const std::string& name = model.definition().name;
    const auto add = [&](const std::string& what, auto* function) {
      benchmark::RegisterBenchmark((what + name).c_str(), function, model)
          ->Unit(benchmark::kMillisecond);
    };
    add("Regenerate ", &Regenerate);
    add("Triangulate ", &Triangulate);
    add("Validate ", &Validate);
    benchmark::RegisterBenchmark(("RandomDesigns " + name).c_str(), &RandomDesigns, model,
                                 invalid_designs)
        ->Unit(benchmark::kSecond)
        ->Iterations(1);
  }
}

}  // namespace
}  // namespace mortise::cad

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const auto models = mortise::cad::ShippedModels();
  if (!models.ok()) {
    std::cerr << models.status() << '\n';
    return 1;
  }
  int invalid_designs = 0;
  mortise::cad::Register(*models, &invalid_designs);
  benchmark::RunSpecifiedBenchmarks();
  return invalid_designs == 0 ? 0 : 1;
}
