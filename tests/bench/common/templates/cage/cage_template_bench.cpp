// How long the boat that ships takes from parameters to a checked surface, to derivatives, and to
// be read; and mean-value coordinates by themselves, of 3,000 points in a cage of 60 vertices.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>

#include "common/base/files.h"
#include "common/mesh/shapes/mean_value_coordinates.h"
#include "common/mesh/surface_check.h"
#include "common/templates/cage/cage_model.h"
#include "common/templates/cage/codec/cage_template_codec.h"

namespace mortise::parametric {
namespace {

std::string BoatText() {
  const char* root = std::getenv("MORTISE_SOURCE_DIR");
  const auto text = ReadFile(std::string(root == nullptr ? "." : root) +
                             "/collection/cage_templates/boat.textproto");
  return text.ok() ? *text : "";
}

// Runs `measure` with the boat, or tells why there is none.
template <typename Measure>
void WithBoat(benchmark::State& state, const Measure& measure) {
  const auto definition = ParseCageTemplateText(BoatText(), "boat");
  if (!definition.ok()) {
    return state.SkipWithError(std::string(definition.status().message()).c_str());
  }
  const auto boat = CageModel::Create(*definition);
  if (!boat.ok()) return state.SkipWithError(std::string(boat.status().message()).c_str());
  state.counters["vertices"] = static_cast<double>(definition->surface.vertices.cols());
  measure(*boat);
}

void EvaluateBoat(benchmark::State& state) {
  WithBoat(state, [&](const CageModel& boat) {
    const Eigen::VectorXd q = boat.Defaults();
    for (auto _ : state) benchmark::DoNotOptimize(boat.Evaluate(q));
  });
}
BENCHMARK(EvaluateBoat)->Unit(benchmark::kMillisecond);

// What of EvaluateBoat is the search for crossings.
void CheckBoat(benchmark::State& state) {
  WithBoat(state, [&](const CageModel& boat) {
    const auto design = boat.Evaluate(boat.Defaults());
    if (!design.ok()) return state.SkipWithError("the boat is not valid");
    for (auto _ : state) {
      benchmark::DoNotOptimize(
          mesh::FindIntersections(design->surface.vertices, design->surface.triangles));
    }
  });
}
BENCHMARK(CheckBoat)->Unit(benchmark::kMillisecond);

void JacobianOfBoat(benchmark::State& state) {
  WithBoat(state, [&](const CageModel& boat) {
    const Eigen::VectorXd q = boat.Defaults();
    for (auto _ : state) benchmark::DoNotOptimize(boat.Jacobian(q));
  });
}
BENCHMARK(JacobianOfBoat)->Unit(benchmark::kMillisecond);

void VolumeOfBoat(benchmark::State& state) {
  WithBoat(state, [&](const CageModel& boat) {
    const Eigen::VectorXd q = boat.Defaults();
    for (auto _ : state) benchmark::DoNotOptimize(boat.Volume(q));
  });
}
BENCHMARK(VolumeOfBoat)->Unit(benchmark::kMillisecond);

void CreateBoat(benchmark::State& state) {
  WithBoat(state, [&](const CageModel& boat) {
    for (auto _ : state) benchmark::DoNotOptimize(CageModel::Create(boat.definition()));
  });
}
BENCHMARK(CreateBoat)->Unit(benchmark::kMillisecond);

void ReadBoat(benchmark::State& state) {
  const std::string text = BoatText();
  for (auto _ : state) benchmark::DoNotOptimize(ParseCageTemplateText(text, "boat"));
}
BENCHMARK(ReadBoat)->Unit(benchmark::kMillisecond);

// A barrel: rings of points around the z axis between two poles.
mesh::SurfaceMesh Barrel(int rings, int sides) {
  mesh::SurfaceMesh barrel;
  barrel.vertices.resize(3, rings * sides + 2);
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sides; ++s) {
      const double angle = 2 * std::numbers::pi * s / sides;
      barrel.vertices.col(r * sides + s) =
          Eigen::Vector3d(std::cos(angle), std::sin(angle), 2.0 * r / (rings - 1) - 1);
    }
  }
  const int south = rings * sides, north = south + 1;
  barrel.vertices.col(south) = Eigen::Vector3d(0, 0, -1.2);
  barrel.vertices.col(north) = Eigen::Vector3d(0, 0, 1.2);
  barrel.triangles.resize(3, 2 * rings * sides);
  int t = 0;
  for (int s = 0; s < sides; ++s) {
    const int next = (s + 1) % sides, top = (rings - 1) * sides;
    barrel.triangles.col(t++) = Eigen::Vector3i(south, next, s);
    barrel.triangles.col(t++) = Eigen::Vector3i(north, top + s, top + next);
    for (int r = 0; r + 1 < rings; ++r) {
      const int a = r * sides + s, b = r * sides + next;
      barrel.triangles.col(t++) = Eigen::Vector3i(a, b, b + sides);
      barrel.triangles.col(t++) = Eigen::Vector3i(a, b + sides, a + sides);
    }
  }
  return barrel;
}

void MeanValueCoordinates(benchmark::State& state) {
  const mesh::SurfaceMesh cage = Barrel(6, 10);
  Eigen::Matrix3Xd points(3, 3000);
  std::mt19937_64 random(1);
  for (double& coordinate : points.reshaped()) {
    coordinate = 1.4 * static_cast<double>(random() >> 11) * 0x1p-53 - 0.7;
  }
  for (auto _ : state) benchmark::DoNotOptimize(mesh::MeanValueCoordinates(cage, points));
  state.counters["cage_vertices"] = static_cast<double>(cage.vertices.cols());
}
BENCHMARK(MeanValueCoordinates)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::parametric

BENCHMARK_MAIN();
