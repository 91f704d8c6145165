// How fast shapes of a map are blended, and what they take: about 400,000 tetrahedra with one
// scalar field, and the 8 samples around an element of three parameters. Counters:
// `updates_per_second` on one core, `against_reading`: how many times as long as only reading the
// same packed numbers takes in the same run, once all of them lie in the processor's caches (one
// set) and once none does (sets beyond any cache, in turn). Of files: bytes of a shape and of a
// canonical mesh, beside what they take in memory.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <vector>

#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/proportions.h"
#include "services/interpolator/shapes/shape_difference.h"
#include "services/interpolator/shapes/shape_file.h"
#include "tests/unit/services/interpolator/shapes/block_designs.h"
#include "tests/unit/services/interpolator/shapes/brought_design.h"

namespace mortise::interpolator {
namespace {

constexpr BlockCells kCells{.along = 64, .across = 32, .high = 33, .unrest = 0.2};
constexpr int kSamples = 8;

// Returns the time that this thread has had a core, s: what others do on the machine meanwhile is
// not counted.
double Now() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A bent beam with a field that is curved in space, and rougher than the shape is.
fields::DesignFields Beam(int sample) {
  const double radius = 0.3 + 0.1 * (sample & 1), turn = 1 + 0.5 * (sample >> 1 & 1),
               thickness = 0.05 + 0.03 * (sample >> 2 & 1);
  fields::DesignFields design = BlockDesign(ArchShape(radius, turn, 0.1, thickness), kCells);
  design.fields.resize(1);
  design.fields[0].name = "von_mises";
  design.fields[0].unit = "Pa";
  for (Eigen::Index node = 0; node < design.nodes.cols(); ++node) {
    const Eigen::Vector3d at = design.nodes.col(node) / thickness;
    design.fields[0].values(0, node) =
        1e8 * std::exp(-at.head<2>().squaredNorm() / 20) * (2 + std::sin(3 * at.z() + sample)) +
        1e5 * std::sin(40 * at.sum());
  }
  return design;
}

struct Samples {
  CanonicalMesh mesh;
  std::vector<PackedShape> shapes;
};

const Samples& TheSamples() {
  static const Samples samples = [] {
    Samples made;
    made.mesh = CanonicalMesh::Create(Beam(0)).value();
    for (int sample = 0; sample < kSamples; ++sample) {
      made.shapes.push_back(
          Pack(Brought(Beam(sample), made.mesh).value().shape, made.mesh).value());
    }
    return made;
  }();
  return samples;
}

// The fastest that the compiler's vectors read.
std::uint64_t Read(const std::vector<std::uint16_t>& numbers, std::size_t count) {
  using Words = std::uint64_t __attribute__((vector_size(32)));
  Words sums[4] = {};
  const std::size_t blocks = count * sizeof(std::uint16_t) / sizeof sums;
  const char* bytes = reinterpret_cast<const char*>(numbers.data());
  for (std::size_t i = 0; i < blocks; ++i, bytes += sizeof sums) {
    Words words[4];
    std::memcpy(words, bytes, sizeof words);
    for (int k = 0; k < 4; ++k) sums[k] += words[k];
  }
  const Words sum = sums[0] + sums[1] + sums[2] + sums[3];
  return sum[0] + sum[1] + sum[2] + sum[3];
}

// Blends `sets` copies of the samples in turn, and then only reads them.
void BM_Blend(benchmark::State& state) {
  const Samples& samples = TheSamples();
  const bool surface_only = state.range(0) != 0;
  const auto sets = static_cast<std::size_t>(state.range(1));
  const std::vector<std::vector<PackedShape>> copies(sets, samples.shapes);
  std::vector<std::vector<WeightedShape>> weighted(sets);
  for (std::size_t set = 0; set < sets; ++set) {
    for (const PackedShape& shape : copies[set]) weighted[set].push_back({&shape, 1.0 / kSamples});
  }
  const BlendedParts parts{surface_only, {0}};
  BlendedShape out;
  std::size_t updates = 0;
  const double begin = Now();
  for (auto _ : state) {
    if (!Blend(weighted[updates++ % sets], samples.mesh, parts, out).ok()) {
      return state.SkipWithError("does not blend");
    }
    benchmark::DoNotOptimize(out.positions.data());
  }
  const double blending = (Now() - begin) / static_cast<double>(updates);
  const std::size_t nodes = out.positions.size() / 3;
  const double begin_reading = Now();
  for (std::size_t i = 0; i < updates; ++i) {
    for (const PackedShape& shape : copies[i % sets]) {
      benchmark::DoNotOptimize(Read(shape.positions, 3 * nodes));
      benchmark::DoNotOptimize(Read(shape.fields[0].numbers, nodes));
    }
  }
  const double reading = (Now() - begin_reading) / static_cast<double>(updates);
  state.counters["tetrahedra"] = samples.mesh.element_count();
  state.counters["nodes"] = static_cast<double>(nodes);
  state.counters["megabytes"] = 1e-6 * kSamples * 4 * 2 * static_cast<double>(nodes);
  state.counters["updates_per_second"] = 1 / blending;
  state.counters["against_reading"] = blending / reading;
}
BENCHMARK(BM_Blend)
    ->ArgNames({"surface_only", "sets"})
    ->Args({0, 1})
    ->Args({0, 40})
    ->Args({1, 1})
    ->Args({1, 400})
    ->Unit(benchmark::kMillisecond);

void BM_Proportions(benchmark::State& state) {
  const Samples& samples = TheSamples();
  BlendedShape out;
  const std::vector<WeightedShape> weighted = {{&samples.shapes[1], 1}};
  if (!Blend(weighted, samples.mesh, {true, {}}, out).ok()) return state.SkipWithError("no blend");
  for (auto _ : state) benchmark::DoNotOptimize(ProportionsOf(out, samples.mesh));
  state.counters["triangles"] = static_cast<double>(samples.mesh.triangles.cols());
}
BENCHMARK(BM_Proportions)->Unit(benchmark::kMillisecond);

void BM_WriteAndReadAShape(benchmark::State& state) {
  const Samples& samples = TheSamples();
  const PackedShape& shape = samples.shapes[3];
  std::size_t size = 0, positions_size = 0;
  double writing = 0, reading = 0;
  for (auto _ : state) {
    double begin = Now();
    const std::string file = WriteShape(shape, samples.mesh).value();
    writing = Now() - begin;
    begin = Now();
    benchmark::DoNotOptimize(ReadShape(file, samples.mesh));
    reading = Now() - begin;
    size = file.size();
  }
  CanonicalMesh bare = samples.mesh;
  bare.fields.clear();
  PackedShape alone = shape;
  alone.fields.clear();
  positions_size = WriteShape(alone, bare).value().size();
  state.counters["write_seconds"] = writing;
  state.counters["read_seconds"] = reading;
  state.counters["kilobytes"] = 1e-3 * static_cast<double>(size);
  state.counters["positions_kilobytes"] = 1e-3 * static_cast<double>(positions_size);
  state.counters["memory_kilobytes"] = 1e-3 * static_cast<double>(shape.ByteSize());
  state.counters["mesh_kilobytes"] =
      1e-3 * static_cast<double>(WriteMesh(samples.mesh).value().size());
}
BENCHMARK(BM_WriteAndReadAShape)->Unit(benchmark::kMillisecond);

void BM_Difference(benchmark::State& state) {
  const Samples& samples = TheSamples();
  const fields::DesignFields truth = Beam(5);
  const ConsistentShape brought = Brought(truth, samples.mesh).value().shape;
  std::vector<WeightedShape> weighted;
  for (const PackedShape& shape : samples.shapes) weighted.push_back({&shape, 1.0 / kSamples});
  BlendedShape out;
  if (!Blend(weighted, samples.mesh, {false, {0}}, out).ok()) {
    return state.SkipWithError("no blend");
  }
  for (auto _ : state) benchmark::DoNotOptimize(Difference(out, samples.mesh, truth, &brought));
}
BENCHMARK(BM_Difference)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::interpolator

BENCHMARK_MAIN();
