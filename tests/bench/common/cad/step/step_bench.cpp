// STEP assemblies of boxes under groups of ten, half of them occurrences of ten products: what
// writing and reading cost, in this process and in one of their own.
#include <benchmark/benchmark.h>

#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "common/cad/step/step_isolation.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"

namespace mortise {
namespace {

constexpr int kGroup = 10;  // parts

cad::StepAssembly Boxes(int count) {
  cad::StepAssembly assembly;
  assembly.name = "boxes";
  assembly.groups.push_back({"boxes", -1});
  for (int i = 0; i < count; ++i) {
    if (i % kGroup == 0) {
      assembly.groups.push_back({absl::StrCat("group ", i / kGroup), 0});
      assembly.groups.back().placement.translation() = Eigen::Vector3d(i, 0, 0);
    }
    if (i % 2 == 0 || i < 2 * kGroup) {
      mesh::PartShape shape;
      shape.name = absl::StrCat("product ", assembly.products.size());
      shape.outline.resize(2, 4);
      shape.outline << 0, 0.04, 0.04, 0, 0, 0, 0.09, 0.09;
      shape.height = 0.5 + 0.001 * i;
      shape.face_names.assign(6, "face");
      assembly.products.push_back({shape.name, *cad::Solid::FromPart(shape), std::nullopt});
    }
    cad::StepPart part;
    part.name = absl::StrCat("part ", i);
    part.group = static_cast<int>(assembly.groups.size()) - 1;
    const bool is_again = i % 2 == 1 && i >= 2 * kGroup;
    part.product = is_again ? i % kGroup : static_cast<int>(assembly.products.size()) - 1;
    part.placement.translation() = Eigen::Vector3d(0.1 * (i % kGroup), 0, 0);
    assembly.parts.push_back(std::move(part));
  }
  return assembly;
}

void WriteStep(benchmark::State& state) {
  const cad::StepAssembly assembly = Boxes(static_cast<int>(state.range(0)));
  std::size_t bytes = 0;
  for (auto _ : state) bytes = cad::WriteStep(assembly)->size();
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(WriteStep)->Arg(500)->Arg(1000)->Arg(2000)->Unit(benchmark::kMillisecond);

void ReadStep(benchmark::State& state) {
  const std::string bytes = *cad::WriteStep(Boxes(static_cast<int>(state.range(0))));
  for (auto _ : state) benchmark::DoNotOptimize(cad::ReadStep(bytes));
}
BENCHMARK(ReadStep)->Arg(500)->Arg(1000)->Arg(2000)->Unit(benchmark::kMillisecond);

void ReadStepInChild(benchmark::State& state) {
  const std::string bytes = *cad::WriteStep(Boxes(static_cast<int>(state.range(0))));
  for (auto _ : state) {
    if (!cad::ReadStepInChild(bytes).ok()) state.SkipWithError("the child fails");
  }
}
BENCHMARK(ReadStepInChild)
    ->Arg(500)
    ->Arg(1000)
    ->Arg(2000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace mortise

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == mortise::cad::kStepChildArgument) {
    return mortise::cad::RunStepChild();
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
