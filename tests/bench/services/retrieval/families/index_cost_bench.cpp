// What the index of what ships costs, template by template: all three descriptors, at the default
// δ, of each template and of the sub-trees of assemblies that are things by themselves, as a worker
// makes them (services/retrieval/service/cover_making.h), on one thread.
//
// Counters: seconds of processor time by `d2`, `voxel` and `light-field`, one after the other, as
// what one made serves the next; their sum `all`; `families`, the template and its sub-trees;
// `evaluations`; `incomplete` covers; the largest `error` of interpolation over δ. What each cover
// took is printed where MORTISE_BENCH_COVERS is set; where MORTISE_BENCH_ERRORS is, too, also how
// far 300 random designs are from it: 99th percentile over δ, and the share of those beyond δ.
//
//   retrieval_index_cost_bench --benchmark_filter=/chair$
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "common/assembly/parametric_assembly.h"
#include "common/assembly/sub_tree.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/retrieval/cover/cover_error.h"
#include "services/retrieval/cover/interpolated_cover.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/families/family_cover.h"
#include "services/retrieval/families/family_manifold.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::retrieval {
namespace {

using TemplatePointer = std::shared_ptr<const templates::Template>;

TemplatePointer CompiledOf(v1::TemplateBundle bundle) {
  const absl::Status completed = templates::FillAndCheck(bundle, templates::Trial::kDefaults);
  if (!completed.ok()) return nullptr;
  const auto compiled = templates::Compile(bundle);
  return compiled.ok() ? *compiled : nullptr;
}

// The template, and those of its sub-trees.
std::vector<TemplatePointer> FamiliesOf(const v1::TemplateBundle& bundle) {
  std::vector<TemplatePointer> families{CompiledOf(bundle)};
  if (!families.front()) return {};
  const auto design =
      families.front()->AssemblyAt(parametric::Defaults(families.front()->parameters()));
  if (!design.ok() || !*design) return families;
  for (const std::string& group : parametric::DistinctSubTrees((*design)->assembly->assembly())) {
    v1::TemplateBundle part = bundle;
    v1::AssemblyTemplate of_assembly;
    of_assembly.set_assembly(bundle.template_().assembly().assembly());
    of_assembly.set_group(group);
    part.mutable_template_()->Clear();
    part.mutable_template_()->set_name(bundle.template_().name());
    *part.mutable_template_()->mutable_assembly() = of_assembly;
    if (TemplatePointer made = CompiledOf(std::move(part))) families.push_back(std::move(made));
  }
  return families;
}

double ProcessorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Cost {
  std::map<std::string, double> seconds;  // by descriptor
  long evaluations = 0;
  int incomplete = 0;
  double error = 0;  // over δ
};

// What random designs say of a cover, where that is asked for.
std::string ErrorsOf(const Manifold& manifold, const Cover& cover, double delta) {
  if (std::getenv("MORTISE_BENCH_ERRORS") == nullptr) return "";
  const auto errors = CoverageErrors(manifold, cover.primitives, {.count = 300, .seed = 77});
  if (!errors.ok()) return "";
  const auto beyond =
      std::count_if(errors->begin(), errors->end(), [&](double error) { return error > delta; });
  return absl::StrFormat(", 99 in 100 within %.2f delta, %.1f %% beyond",
                         Quantile(*errors, 0.99) / delta,
                         100.0 * static_cast<double>(beyond) / static_cast<double>(errors->size()));
}

void CoverFamily(const TemplatePointer& function, Cost* cost) {
  std::vector<std::shared_ptr<const Descriptor>> descriptors;
  for (const std::string& name : DescriptorNames()) {
    descriptors.push_back(MakeDescriptor(name).value());
  }
  const auto designs = std::make_shared<DescribedDesigns>(function, descriptors);
  for (std::size_t place = 0; place < descriptors.size(); ++place) {
    const std::string& name = descriptors[place]->properties().name;
    const double begin = ProcessorSeconds();
    const double delta = DefaultDelta(*descriptors[place]);
    const auto manifold = MakeFamilyManifold(function, descriptors[place], designs, place);
    if (!manifold.ok()) continue;
    const auto cover = CoverByInterpolation(**manifold, FamilyCoverOptions(delta, *function));
    const double seconds = ProcessorSeconds() - begin;
    cost->seconds[name] += seconds;
    if (!cover.ok()) {
      std::printf("%s, %s: %s\n", function->head().title.c_str(), name.c_str(),
                  std::string(cover.status().message()).c_str());
      continue;
    }
    cost->evaluations += cover->evaluations;
    cost->incomplete += cover->end == CoverEnd::kCovered ? 0 : 1;
    cost->error = std::max(cost->error, cover->interpolation_error / delta);
    if (std::getenv("MORTISE_BENCH_COVERS") == nullptr) continue;
    std::printf(
        "%s, %zu parameters, %s: %.2f s, %ld evaluations, %ld fail, %zu primitives, error "
        "%.2f delta, end %d%s\n",
        function->head().title.c_str(), function->parameters().size(), name.c_str(), seconds,
        cover->evaluations, cover->failures, cover->primitives.size(),
        cover->interpolation_error / delta, static_cast<int>(cover->end),
        ErrorsOf(**manifold, *cover, delta).c_str());
    std::fflush(stdout);
  }
}

void BM_Index(benchmark::State& state, const v1::TemplateBundle& bundle) {
  Cost cost;
  std::size_t families = 0;
  for (auto _ : state) {
    const std::vector<TemplatePointer> all = FamiliesOf(bundle);
    families = all.size();
    for (const TemplatePointer& function : all) CoverFamily(function, &cost);
  }
  double sum = 0;
  for (const auto& [name, seconds] : cost.seconds) {
    state.counters[name] = seconds;
    sum += seconds;
  }
  state.counters["all"] = sum;
  state.counters["families"] = static_cast<double>(families);
  state.counters["evaluations"] = static_cast<double>(cost.evaluations);
  state.counters["incomplete"] = cost.incomplete;
  state.counters["error"] = cost.error;
}

// The templates that the catalog has of what ships: each assembly has one of its own, unless one of
// the drawn templates is made of it.
void RegisterAll() {
  const auto add = [](const std::string& name, const v1::TemplateBundle& bundle) {
    benchmark::RegisterBenchmark(("BM_Index/" + name).c_str(), BM_Index, bundle)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  };
  std::set<std::string> made;
  for (const v1::Template& each : templates::ShippedCollection().templates) {
    v1::TemplateBundle bundle = templates::ShippedTemplate(each.name());
    const std::string assembly = each.assembly().assembly();
    if (!assembly.empty()) {
      *bundle.mutable_assembly() = templates::ShippedAssembly(assembly).assembly();
      made.insert(assembly);
    }
    add(each.name(), bundle);
  }
  for (const v1::Assembly& each : templates::ShippedCollection().assemblies) {
    if (!made.contains(each.name())) add(each.name(), templates::ShippedAssembly(each.name()));
  }
}

}  // namespace
}  // namespace mortise::retrieval

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  mortise::retrieval::RegisterAll();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
