// Boards with bores on rods that run through them: levels that divide shapes are found and held,
// and the designs that are tried are looked at as they are, stretched in pieces.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "common/mesh/point_merger.h"
#include "common/mesh/shapes/round_faces.h"
#include "common/mesh/shapes/shape_levels.h"
#include "tests/unit/common/mesh/round_solids.h"

namespace mortise::parametric {
namespace {

constexpr double kCell = 0.1;  // m, of board around each bore
constexpr double kRadius = 0.008;
constexpr double kThick = 0.018;
constexpr int kSides = 32;

// On the rim of a cell whose middle is the origin, in a direction.
Eigen::Vector2d OnRim(double angle) {
  const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
  return kCell / 2 / along.cwiseAbs().maxCoeff() * along;
}

// A plate of columns × rows cells with a bore in the middle of each, its lower corner at the
// origin.
mesh::SurfaceMesh BoredPlate(int columns, int rows) {
  mesh::PointMerger points(1e-9);
  std::vector<Eigen::Vector3i> triangles;
  const auto at = [&](const Eigen::Vector2d& place, double z) {
    return points.IndexOf({place.x(), place.y(), z});
  };
  const auto quad = [&](int a, int b, int c, int d) {
    triangles.emplace_back(a, b, c);
    triangles.emplace_back(a, c, d);
  };
  const Eigen::Vector2d size = kCell * Eigen::Vector2d(columns, rows);
  for (int cell = 0; cell < columns * rows; ++cell) {
    const Eigen::Vector2d middle =
        kCell * Eigen::Vector2d(cell % columns + 0.5, cell / columns + 0.5);
    for (int side = 0; side < kSides; ++side) {
      const double from = 2 * std::numbers::pi * side / kSides;
      const double to = 2 * std::numbers::pi * (side + 1) / kSides;
      const auto bore = [&](double angle) -> Eigen::Vector2d {
        return middle + kRadius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      };
      const Eigen::Vector2d a = bore(from), b = bore(to);
      const Eigen::Vector2d c = middle + OnRim(to), d = middle + OnRim(from);
      quad(at(a, 0), at(b, 0), at(c, 0), at(d, 0));
      quad(at(d, kThick), at(c, kThick), at(b, kThick), at(a, kThick));
      quad(at(b, 0), at(a, 0), at(a, kThick), at(b, kThick));
      const auto is_edge = [&](int axis, double place) {
        return std::abs(c[axis] - place) < 1e-9 && std::abs(d[axis] - place) < 1e-9;
      };
      if (is_edge(0, 0) || is_edge(1, 0) || is_edge(0, size[0]) || is_edge(1, size[1])) {
        quad(at(d, 0), at(c, 0), at(c, kThick), at(d, kThick));
      }
    }
  }
  mesh::SurfaceMesh plate;
  plate.vertices = points.Points();
  plate.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    plate.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  return plate;
}

AssemblyPart Part(const std::string& name, const mesh::SurfaceMesh& surface,
                  const Eigen::Vector3d& place, bool is_bought) {
  AssemblyPart part;
  part.name = name;
  part.item = "items/" + name;
  part.box = {surface.vertices.rowwise().minCoeff() + place,
              surface.vertices.rowwise().maxCoeff() + place};
  const Eigen::Vector3d size = part.box.size();
  for (int axis = 0; axis < 3; ++axis) {
    part.limits[static_cast<std::size_t>(axis)] = {size[axis] / 2, 2 * size[axis]};
    if (is_bought && axis < 2) {
      part.limits[static_cast<std::size_t>(axis)] = {size[axis], size[axis]};
    }
  }
  // A board's bores are faces of their own; so are a rod's ends.
  Eigen::VectorXi face(surface.triangles.cols());
  std::vector<std::string> names = {"flat", "round"};
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t));
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    face[t] = normal.cwiseAbs().maxCoeff() < 1 - 1e-12 ? 1 : 0;
  }
  auto shape = mesh::MakeDrawnShape(surface, face, names, surface.vertices.rowwise().minCoeff(),
                                    surface.vertices.rowwise().maxCoeff());
  if (shape.ok()) part.shape = std::make_shared<const mesh::DrawnShape>(*std::move(shape));
  return part;
}

// `boards` one above the other on columns × rows rods.
Assembly Rack(int boards, int columns, int rows) {
  Assembly rack;
  rack.name = "rack";
  rack.groups = {{"rack", -1}};
  const mesh::SurfaceMesh plate = BoredPlate(columns, rows);
  const double height = 0.3 * (boards - 1) + kThick;
  for (int i = 0; i < boards; ++i) {
    // At unequal heights, so that they are no row.
    const double z = 0.3 * i + (i % 2 == 1 && i + 1 < boards ? 0.05 : 0);
    rack.parts.push_back(Part("board " + std::to_string(i), plate, {0, 0, z}, false));
  }
  const mesh::SurfaceMesh rod = mesh::Cylinder(kRadius, height, kSides);
  for (int cell = 0; cell < columns * rows; ++cell) {
    const Eigen::Vector3d place(kCell * (cell % columns + 0.5), kCell * (cell / columns + 0.5),
                                -rod.vertices.row(2).minCoeff());
    rack.parts.push_back(Part("rod " + std::to_string(cell), rod, place, true));
  }
  return rack;
}

void BM_LevelsOfBoredPlate(benchmark::State& state) {
  const auto cells = static_cast<int>(state.range(0));
  const AssemblyPart plate = Part("plate", BoredPlate(cells, cells), {0, 0, 0}, false);
  if (plate.shape == nullptr) return state.SkipWithError("no shape");
  for (auto _ : state) {
    const std::vector<mesh::ShapeLevel> levels = mesh::LevelsOf(*plate.shape);
    benchmark::DoNotOptimize(mesh::RoundFacesOf(*plate.shape));
    benchmark::DoNotOptimize(mesh::DividedAt(*plate.shape, levels));
  }
  state.counters["triangles"] = static_cast<double>(plate.shape->triangles.cols());
}
BENCHMARK(BM_LevelsOfBoredPlate)->Arg(2)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);

void BM_WholeRack(benchmark::State& state) {
  const Assembly rack = Rack(static_cast<int>(state.range(0)), 2, 2);
  for (auto _ : state) {
    const auto parametric = ParametricAssembly::Create(rack);
    if (!parametric.ok()) {
      state.SkipWithError(std::string(parametric.status().message()).c_str());
      return;
    }
    state.counters["degrees_of_freedom"] = parametric->feasible_set().degrees_of_freedom();
    state.counters["held_sizes"] = static_cast<double>(parametric->HeldSizes().size());
  }
  state.counters["parts"] = static_cast<double>(rack.parts.size());
}
BENCHMARK(BM_WholeRack)->Arg(2)->Arg(8)->Arg(32)->Unit(benchmark::kMillisecond);

void BM_AdjustRack(benchmark::State& state) {
  const auto parametric = ParametricAssembly::Create(Rack(8, 2, 2));
  if (!parametric.ok()) return state.SkipWithError("not parametrised");
  double wide = 0.2;
  for (auto _ : state) {
    wide = wide > 0.35 ? 0.2 : wide + 0.001;
    const auto adjusted = parametric->Adjust(parametric->drawn(), {{{"board 0", Axis::kX}, wide}},
                                             DemandPolicy::kNearest);
    if (!adjusted.ok()) return state.SkipWithError("not adjusted");
    if (state.range(0) != 0) benchmark::DoNotOptimize(parametric->FaultsAt(adjusted->q));
  }
}
BENCHMARK(BM_AdjustRack)->ArgName("faults")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::parametric

BENCHMARK_MAIN();
