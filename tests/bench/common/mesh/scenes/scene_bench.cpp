// Mesh files of 50,000 and of a million triangles: what reading costs, in this process and in one
// of its own, and what it costs to find the connected pieces.
#include <benchmark/benchmark.h>

#include <string>
#include <string_view>

#include "common/mesh/scenes/mesh_components.h"
#include "common/mesh/scenes/scene_import.h"
#include "common/mesh/scenes/scene_reader.h"
#include "tests/support/scene_files.h"

namespace mortise {
namespace {

constexpr int kSmall = 158;  // cells: 49,928 triangles
constexpr int kLarge = 708;  // cells: 1,002,528 triangles

using Writer = std::string (*)(const testing::PlainMesh&);

std::string WritePly(const testing::PlainMesh& mesh) { return testing::WriteBinaryPly(mesh); }
std::string WriteGlb(const testing::PlainMesh& mesh) { return testing::WriteGlb(mesh); }
std::string WriteStl(const testing::PlainMesh& mesh) { return testing::WriteBinaryStl(mesh); }
std::string WriteObj(const testing::PlainMesh& mesh) { return testing::WriteObj(mesh); }

void Import(benchmark::State& state, Writer write) {
  const std::string bytes = write(testing::Sheet(static_cast<int>(state.range(0))));
  for (auto _ : state) {
    if (!mesh::ImportScene(bytes, "").ok()) state.SkipWithError("the file is refused");
  }
  state.counters["bytes"] = static_cast<double>(bytes.size());
}

void ReadInChild(benchmark::State& state, Writer write) {
  const std::string bytes = write(testing::Sheet(static_cast<int>(state.range(0))));
  for (auto _ : state) {
    if (!mesh::ReadScene(bytes, "").ok()) state.SkipWithError("the file is refused");
  }
}

void Connect(benchmark::State& state, double tolerance) {
  const auto scene =
      mesh::ImportScene(WritePly(testing::Sheet(static_cast<int>(state.range(0)))), "");
  const mesh::SceneComponent& component = scene->components[0];
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        mesh::FindConnected(component.vertices, component.triangles, tolerance));
  }
}

#define MORTISE_SCENE_BENCH(function, name, argument) \
  BENCHMARK_CAPTURE(function, name, argument)         \
      ->Arg(kSmall)                                   \
      ->Arg(kLarge)                                   \
      ->Unit(benchmark::kMillisecond)                 \
      ->UseRealTime()
MORTISE_SCENE_BENCH(Import, ply, WritePly);
MORTISE_SCENE_BENCH(Import, glb, WriteGlb);
MORTISE_SCENE_BENCH(Import, stl, WriteStl);
MORTISE_SCENE_BENCH(Import, obj, WriteObj);
MORTISE_SCENE_BENCH(ReadInChild, ply, WritePly);
MORTISE_SCENE_BENCH(ReadInChild, glb, WriteGlb);
MORTISE_SCENE_BENCH(Connect, exactly, 0);
MORTISE_SCENE_BENCH(Connect, within_a_tolerance, 1e-6);

}  // namespace
}  // namespace mortise

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == mortise::mesh::kSceneChildArgument) {
    return mortise::mesh::RunSceneChild();
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
