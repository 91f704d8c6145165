// Control variables of everything that ships: how many there are, how many keep their names while
// each parameter goes to its ends by itself, and what finding them takes of what meshing takes.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>

#include "common/base/elapsed_time.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/fields/control_variables.h"
#include "common/mesh/face_edges.h"
#include "common/templates/features/edge_samples.h"
#include "common/templates/template_codec.h"
#include "services/simulator/analysis/design_fields.h"
#include "services/simulator/worker/template_model.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

absl::StatusOr<std::shared_ptr<const templates::Template>> FunctionOf(const std::string& name) {
  v1::TemplateBundle bundle = templates::ShippedTemplate(name);
  if (bundle.template_().has_assembly()) {
    const v1::Template shipped = bundle.template_();
    bundle = templates::ShippedAssembly(shipped.assembly().assembly());
    *bundle.mutable_template_() = shipped;
  }
  MORTISE_RETURN_IF_ERROR(templates::FillAndCheck(bundle, templates::Trial::kDefaults));
  return templates::Compile(bundle);
}

absl::StatusOr<DesignModel> ModelAt(const templates::Template& function, const Eigen::VectorXd& q) {
  const auto design = function.Evaluate(q);
  if (!design.ok()) return design.status();
  return MakeDesignModel(function, q, *design, {.control_variables = true});
}

absl::StatusOr<mesh::ControlVariables> VariablesOf(const DesignModel& model) {
  const auto shape = CollectFields(model, DesignAnalysis(), {});
  if (!shape.ok()) return shape.status();
  return fields::ControlVariablesOf(*shape);
}

// Of all points, or only of those at vertices. Shorter edges have fewer points between.
std::set<std::string> NamesOf(const mesh::ControlVariables& variables, bool of_vertices) {
  std::set<std::string> names;
  for (const auto& point : variables.points) {
    if (of_vertices && point.name.find(" at ") != std::string::npos) continue;
    names.insert(point.name);
  }
  return names;
}

struct Kept {
  double points = 1, vertices = 1;  // shares
};

double ShareOf(const std::set<std::string>& names, const std::set<std::string>& others) {
  if (names.empty()) return 1;
  const auto kept =
      std::ranges::count_if(names, [&](const std::string& name) { return others.contains(name); });
  return static_cast<double>(kept) / static_cast<double>(names.size());
}

// The least share of the names that designs at ends of parameters have, too.
Kept LeastKept(const templates::Template& function, const mesh::ControlVariables& of_defaults) {
  Kept least;
  const Eigen::VectorXd defaults = parametric::Defaults(function.parameters());
  for (Eigen::Index k = 0; k < defaults.size(); ++k) {
    const parametric::Parameter& range = function.parameters()[static_cast<std::size_t>(k)];
    for (const double end : {range.minimum, range.maximum}) {
      Eigen::VectorXd q = defaults;
      q[k] = end;
      const auto model = ModelAt(function, q);
      if (!model.ok()) continue;  // not all ends are designs
      const auto variables = VariablesOf(*model);
      if (!variables.ok()) continue;
      least.points =
          std::min(least.points, ShareOf(NamesOf(of_defaults, false), NamesOf(*variables, false)));
      least.vertices =
          std::min(least.vertices, ShareOf(NamesOf(of_defaults, true), NamesOf(*variables, true)));
    }
  }
  return least;
}

double SecondsToFind(const templates::Template& function, const DesignModel& model,
                     const mesh::TetrahedralMesh& mesh) {
  const double spacing = fields::ControlSpacing(mesh.nodes);
  const Eigen::VectorXd q = parametric::Defaults(function.parameters());
  if (!model.control_variables) {
    const auto start = Clock::now();
    benchmark::DoNotOptimize(mesh::FindControlVariables(
        mesh::OuterFaces(mesh.nodes, mesh.face_triangles, mesh.face_triangle_face, mesh.faces,
                         mesh.part_names),
        spacing));
    return SecondsSince(start);
  }
  const auto solids = function.Solids(q);
  const auto design = function.Evaluate(q);
  const auto start = Clock::now();
  benchmark::DoNotOptimize(
      cad::FindControlVariables(solids->front(), design->parts[0].faceted->face_names, spacing));
  return SecondsSince(start);
}

void Finding(benchmark::State& state, const std::string& name) {
  const auto function = FunctionOf(name);
  if (!function.ok()) return state.SkipWithError("no template");
  for (auto unused : state) {
    const auto model = ModelAt(**function, parametric::Defaults((*function)->parameters()));
    if (!model.ok()) return state.SkipWithError("no model");
    const auto start = Clock::now();
    const auto mesh = mesh::MeshAssembly(model->surface);
    if (!mesh.ok()) return state.SkipWithError("no mesh");
    const double meshing = SecondsSince(start);
    const double finding = SecondsToFind(**function, *model, *mesh);
    const auto variables = VariablesOf(*model);
    if (!variables.ok()) return state.SkipWithError("no variables");
    state.counters["points"] = static_cast<double>(variables->points.size());
    state.counters["paths"] = static_cast<double>(variables->paths.size());
    state.counters["of_solid"] = model->control_variables.has_value();
    const Kept kept = LeastKept(**function, *variables);
    state.counters["kept"] = kept.points;
    state.counters["kept_vertices"] = kept.vertices;
    state.counters["of_meshing"] = finding / meshing;
    state.counters["ms"] = finding * 1e3;
  }
}

void RegisterAll() {
  for (const v1::Template& shipped : templates::ShippedCollection().templates) {
    const std::string& name = shipped.name();
    benchmark::RegisterBenchmark(name.c_str(), Finding, name)
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1);
  }
}

}  // namespace
}  // namespace mortise::simulator

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  mortise::simulator::RegisterAll();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
