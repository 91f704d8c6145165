// Covers of families that ship, with 3, 5 and 7 parameters, by each descriptor and over a range of
// δ: errors that are measured on the families themselves (Figure 4-8) and costs (Figure 4-9). What
// a family has more parameters than is held in its middle.
//
// Arguments: the family (0: table, 3 parameters; 1: toy wagon, 5; 2: step stool, 7), the descriptor
// (0: d2, 1: voxel, 2: light-field), δ in hundredths of how far apart unlike shapes are. Counters:
// `cost` of the mixed cover, of `points` alone and of `tangents` alone; `saving`, the dearer of
// these over the mixed; `coverage` and `fitting`, 99th percentiles of errors over δ; `evaluations`
// of the family for the mixed cover.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "common/templates/template_codec.h"
#include "services/retrieval/cover/cover_error.h"
#include "services/retrieval/cover/interpolated_cover.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/families/family_manifold.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct FamilyCase {
  const char* name;
  Index parameters;
};
constexpr FamilyCase kFamilies[] = {
    {"templates/table", 3}, {"assemblies/toy-wagon", 5}, {"assemblies/step-stool", 7}};

std::shared_ptr<const templates::Template> Compiled(const std::string& name) {
  v1::TemplateBundle bundle = name.starts_with("assemblies/") ? templates::ShippedAssembly(name)
                                                              : templates::ShippedTemplate(name);
  if (!templates::FillAndCheck(bundle, templates::Trial::kDefaults).ok()) return nullptr;
  const auto compiled = templates::Compile(bundle);
  return compiled.ok() ? *compiled : nullptr;
}

// The manifold's first parameters, the others held in the middle of its samples.
FunctionManifold FirstParameters(std::shared_ptr<const Manifold> whole, Index count) {
  VectorXd middle = VectorXd::Zero(whole->parameters());
  const std::vector<VectorXd> samples = whole->Sample(256, 5).value();
  for (const VectorXd& q : samples) middle += q / static_cast<double>(samples.size());
  const LinearConstraints& limits = whole->constraints();
  const Index held = middle.size() - count;
  const VectorXd bounds = limits.bounds - limits.normals.rightCols(held) * middle.tail(held);
  std::vector<Index> rows;
  for (Index i = 0; i < bounds.size(); ++i) {
    if (limits.normals.row(i).head(count).norm() > 1e-9) rows.push_back(i);
  }
  const auto full = [middle, count](const VectorXd& q) {
    VectorXd all = middle;
    all.head(count) = q;
    return all;
  };
  ManifoldFunctions functions;
  functions.lower = VectorXd::Constant(count, -100);
  functions.upper = VectorXd::Constant(count, 100);
  functions.cuts = {limits.normals(rows, Eigen::seqN(0, count)), bounds(rows)};
  functions.dimension = whole->dimension();
  functions.noise = whole->noise();
  functions.evaluate = [whole, full](const VectorXd& q) { return whole->Evaluate(full(q)); };
  functions.structure = [whole, full](const VectorXd& q) { return whole->Structure(full(q)); };
  return FunctionManifold(std::move(functions));
}

double CostOf(const Manifold& manifold, CoverOptions options, CoverKind kind) {
  options.kind = kind;
  const auto cover = CoverByInterpolation(manifold, options);
  return cover.ok() && cover->end == CoverEnd::kCovered ? static_cast<double>(cover->cost) : 0;
}

void BM_FamilyErrors(benchmark::State& state) {
  const FamilyCase& family = kFamilies[state.range(0)];
  const std::string name = DescriptorNames()[static_cast<std::size_t>(state.range(1))];
  const std::shared_ptr<const Descriptor> descriptor = MakeDescriptor(name).value();
  state.SetLabel(std::string(family.name) + " " + name);
  auto whole = MakeFamilyManifold(Compiled(family.name), descriptor);
  if (!whole.ok()) return state.SkipWithError(whole.status().ToString().c_str());
  if ((*whole)->parameters() < family.parameters) {
    return state.SkipWithError("it has fewer parameters");
  }
  const FunctionManifold manifold = FirstParameters(*std::move(whole), family.parameters);
  CoverOptions options;
  options.delta =
      1e-2 * static_cast<double>(state.range(2)) * descriptor->properties().natural_scale;
  options.seed = 5;
  options.threads = 2;
  options.most_primitives = 20'000;
  Cover cover;
  for (auto _ : state) {
    auto made = CoverByInterpolation(manifold, options);
    if (!made.ok()) return state.SkipWithError(made.status().ToString().c_str());
    cover = *std::move(made);
  }
  const double points = CostOf(manifold, options, CoverKind::kPoints);
  const double tangents = CostOf(manifold, options, CoverKind::kTangents);
  state.counters["cost"] = static_cast<double>(cover.cost);
  state.counters["points"] = points;
  state.counters["tangents"] = tangents;
  state.counters["saving"] = std::max(points, tangents) / static_cast<double>(cover.cost);
  state.counters["evaluations"] = static_cast<double>(cover.evaluations);
  state.counters["complete"] = cover.end == CoverEnd::kCovered ? 1 : 0;
  const auto coverage =
      CoverageErrors(manifold, cover.primitives, {.count = 1000, .seed = 77, .threads = 2});
  const auto fitting =
      FittingErrors(manifold, cover.primitives, {.count = 150, .seed = 78, .threads = 2});
  if (!coverage.ok() || !fitting.ok()) return state.SkipWithError("no errors");
  state.counters["coverage"] = Quantile(*coverage, 0.99) / options.delta;
  state.counters["fitting"] = Quantile(*fitting, 0.99) / options.delta;
}

BENCHMARK(BM_FamilyErrors)
    ->ArgsProduct({{0, 1, 2}, {0, 1, 2}, {10, 25, 50}})
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::retrieval

BENCHMARK_MAIN();
