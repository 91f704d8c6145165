// What templates that ship take to be evaluated and covered, as an index does.
//
// BM_Evaluation: counters `parameters`, K; `failed`, of 100 samples that a manifold draws, how many
// in 100 cannot be made; milliseconds of processor time of `design` (Template::Evaluate) and of an
// evaluation of the manifold by each descriptor.
// BM_Cover, at the default δ: counters `evaluations`, `failed` of them, `samples`, `primitives`,
// `cost`, and whether it was `complete`; `coverage`, the 99th percentile of errors over δ, where
// MORTISE_BENCH_ERRORS is set. The time is the processor's.
//
//   retrieval_families_bench --benchmark_filter=Cover/d2/.*/step-stool
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/templates/template_codec.h"
#include "services/retrieval/cover/cover_error.h"
#include "services/retrieval/cover/interpolated_cover.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/families/family_cover.h"
#include "services/retrieval/families/family_manifold.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::retrieval {
namespace {

constexpr int kSamples = 100;
constexpr int kTimed = 20;

std::shared_ptr<const templates::Template> CompiledOf(v1::TemplateBundle bundle) {
  const absl::Status completed = templates::FillAndCheck(bundle, templates::Trial::kDefaults);
  if (!completed.ok()) return nullptr;
  const auto compiled = templates::Compile(bundle);
  return compiled.ok() ? *compiled : nullptr;
}

// Milliseconds of processor time a point.
double TimeOf(const std::vector<Eigen::VectorXd>& points,
              const std::function<void(const Eigen::VectorXd&)>& work) {
  const std::clock_t begin = std::clock();
  for (const Eigen::VectorXd& q : points) work(q);
  return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC /
         static_cast<double>(points.size());
}

void BM_Evaluation(benchmark::State& state, const v1::TemplateBundle& bundle) {
  const auto function = CompiledOf(bundle);
  if (!function) return state.SkipWithError("it does not compile");
  state.counters["parameters"] = static_cast<double>(function->parameters().size());
  for (auto _ : state) {
    for (const std::string& name : DescriptorNames()) {
      const std::shared_ptr<const Descriptor> descriptor = MakeDescriptor(name).value();
      const auto manifold = MakeFamilyManifold(function, descriptor);
      if (!manifold.ok()) return state.SkipWithError(manifold.status().ToString().c_str());
      const auto samples = (*manifold)->Sample(kSamples, 1);
      if (!samples.ok()) return state.SkipWithError(samples.status().ToString().c_str());
      std::vector<Eigen::VectorXd> made;
      for (const Eigen::VectorXd& q : *samples) {
        if (function->StructureAt(q).ok()) made.push_back(q);
      }
      state.counters["failed"] = static_cast<double>(samples->size() - made.size());
      if (made.size() > kTimed) made.resize(kTimed);
      state.counters[name] = TimeOf(made, [&](const Eigen::VectorXd& q) {
        benchmark::DoNotOptimize((*manifold)->Evaluate(q).ok());
      });
      if (name != "d2") continue;
      state.counters["design"] = TimeOf(made, [&](const Eigen::VectorXd& q) {
        benchmark::DoNotOptimize(function->Evaluate(q).ok());
      });
    }
  }
}

void BM_Cover(benchmark::State& state, const std::string& descriptor_name,
              const v1::TemplateBundle& bundle) {
  const auto function = CompiledOf(bundle);
  if (!function) return state.SkipWithError("it does not compile");
  const std::shared_ptr<const Descriptor> descriptor = MakeDescriptor(descriptor_name).value();
  const double delta = DefaultDelta(*descriptor);
  for (auto _ : state) {
    const auto manifold = MakeFamilyManifold(function, descriptor);
    if (!manifold.ok()) return state.SkipWithError(manifold.status().ToString().c_str());
    const auto cover = CoverByInterpolation(**manifold, FamilyCoverOptions(delta, *function));
    if (!cover.ok()) return state.SkipWithError(cover.status().ToString().c_str());
    state.counters["evaluations"] = static_cast<double>(cover->evaluations);
    state.counters["failed"] = static_cast<double>(cover->failures);
    state.counters["samples"] = static_cast<double>(cover->samples);
    state.counters["primitives"] = static_cast<double>(cover->primitives.size());
    state.counters["cost"] = static_cast<double>(cover->cost);
    state.counters["complete"] = cover->end == CoverEnd::kCovered ? 1 : 0;
    if (std::getenv("MORTISE_BENCH_ERRORS") == nullptr) continue;
    state.PauseTiming();
    const auto errors = CoverageErrors(**manifold, cover->primitives, {.count = 1000, .seed = 77});
    if (errors.ok()) state.counters["coverage"] = Quantile(*errors, 0.99) / delta;
    state.ResumeTiming();
  }
}

// A template of an assembly needs that beside it.
v1::TemplateBundle WithAssembly(v1::TemplateBundle bundle) {
  const std::string& name = bundle.template_().assembly().assembly();
  if (!name.empty()) *bundle.mutable_assembly() = templates::ShippedAssembly(name).assembly();
  return bundle;
}

void RegisterAll() {
  const auto add = [](const std::string& name, const v1::TemplateBundle& bundle) {
    benchmark::RegisterBenchmark(("BM_Evaluation/" + name).c_str(), BM_Evaluation, bundle)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
    for (const std::string& descriptor : DescriptorNames()) {
      benchmark::RegisterBenchmark(("BM_Cover/" + descriptor + "/" + name).c_str(), BM_Cover,
                                   descriptor, bundle)
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  };
  for (const v1::Template& each : templates::ShippedCollection().templates) {
    add(each.name(), WithAssembly(templates::ShippedTemplate(each.name())));
  }
  for (const v1::Assembly& each : templates::ShippedCollection().assemblies) {
    add(each.name(), templates::ShippedAssembly(each.name()));
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
