// How taking a scene apart and making parts of it grows with its triangles, where none hangs
// together with another, where all stand in one plane across x, where all meet at one edge, and
// where they are boxes that touch in corners. `against_linear` is how many times as long as in
// proportion to a tenth of them it takes: 1 is linear, 10 is quadratic.
#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>
#include <functional>

#include "common/base/random.h"
#include "common/mesh/parts/scene_parts.h"
#include "common/mesh/parts/surface_pieces.h"

namespace mortise {
namespace {

using SceneOf = std::function<mesh::SceneComponent(int triangles)>;

mesh::SceneComponent Loose(int triangles, bool in_a_wall) {
  Random random(7);
  mesh::SceneComponent scene{"", Eigen::Matrix3Xd(3, 3 * triangles),
                             Eigen::Matrix3Xi(3, triangles)};
  for (int t = 0; t < triangles; ++t) {
    Eigen::Vector3d at(random.Uniform(), random.Uniform(), random.Uniform());
    if (in_a_wall) at.x() = 0;
    scene.vertices.col(3 * t) = at;
    scene.vertices.col(3 * t + 1) = at + Eigen::Vector3d(0, 1e-3, 0);
    scene.vertices.col(3 * t + 2) = at + Eigen::Vector3d(1e-3, 0, 1e-3);
    scene.triangles.col(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  }
  return scene;
}

mesh::SceneComponent Scattered(int triangles) { return Loose(triangles, false); }
mesh::SceneComponent Wall(int triangles) { return Loose(triangles, true); }

// Triangles about one edge, as the pages of a book.
mesh::SceneComponent Book(int triangles) {
  mesh::SceneComponent scene{"", Eigen::Matrix3Xd(3, triangles + 2),
                             Eigen::Matrix3Xi(3, triangles)};
  scene.vertices.col(0).setZero();
  scene.vertices.col(1) = Eigen::Vector3d::UnitZ();
  for (int t = 0; t < triangles; ++t) {
    const double angle = 6.28 * t / triangles;
    scene.vertices.col(t + 2) << std::cos(angle), std::sin(angle), 0.5;
    scene.triangles.col(t) << 0, 1, t + 2;
  }
  return scene;
}

// Tetrahedra in a row, each of which touches the next at a corner.
mesh::SceneComponent Chain(int triangles) {
  const int count = triangles / 4;
  mesh::SceneComponent scene{"", Eigen::Matrix3Xd(3, 4 * count), Eigen::Matrix3Xi(3, 4 * count)};
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d at(i, 0, 0);
    scene.vertices.middleCols<4>(4 * i) << at, at + Eigen::Vector3d(1, 0, 0),
        at + Eigen::Vector3d(0.5, 1, 0), at + Eigen::Vector3d(0.5, 0, 1);
    scene.triangles.middleCols<4>(4 * i) << 0, 0, 1, 2, 2, 1, 2, 0, 1, 3, 3, 3;
    scene.triangles.middleCols<4>(4 * i).array() += 4 * i;
  }
  return scene;
}

double SecondsFor(const mesh::SceneComponent& component, bool with_parts) {
  mesh::Scene scene;
  scene.components = {component};
  const std::clock_t begun = std::clock();  // of the processor, as others may be at work
  if (with_parts) {
    benchmark::DoNotOptimize(mesh::PartsOf(scene, 40));
  } else {
    benchmark::DoNotOptimize(mesh::PiecesOf(scene));
  }
  return static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
}

void Grow(benchmark::State& state, const SceneOf& make, bool with_parts) {
  const int triangles = static_cast<int>(state.range(0));
  const mesh::SceneComponent all = make(triangles), tenth = make(triangles / 10);
  double of_all = 0, of_tenth = 0;
  for (auto _ : state) {
    of_tenth += SecondsFor(tenth, with_parts);
    of_all += SecondsFor(all, with_parts);
  }
  state.counters["against_linear"] = of_all / (10 * of_tenth);
}

#define MORTISE_PARTS_BENCH(name, scene, with_parts) \
  BENCHMARK_CAPTURE(Grow, name, scene, with_parts)   \
      ->Arg(10'000)                                  \
      ->Arg(50'000)                                  \
      ->Arg(100'000)                                 \
      ->Unit(benchmark::kMillisecond)                \
      ->UseRealTime()
MORTISE_PARTS_BENCH(pieces_of_scattered, Scattered, false);
MORTISE_PARTS_BENCH(pieces_of_a_book, Book, false);
MORTISE_PARTS_BENCH(pieces_of_a_chain, Chain, false);
MORTISE_PARTS_BENCH(parts_of_scattered, Scattered, true);
MORTISE_PARTS_BENCH(parts_of_a_wall, Wall, true);
MORTISE_PARTS_BENCH(parts_of_a_chain, Chain, true);

}  // namespace
}  // namespace mortise

BENCHMARK_MAIN();
