// Automatic parametrisation of shelves of growing size: patterns, relationships, feasible set, and
// what a random point costs afterwards.
#include <benchmark/benchmark.h>

#include <memory>
#include <random>
#include <string>

#include "common/assembly/assembly_design.h"
#include "common/assembly/model/linear_design.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/parametric_assembly.h"
#include "common/assembly/relations/feasible_set.h"
#include "tests/unit/common/assembly/bookcase.h"

namespace mortise::parametric {
namespace {

constexpr double kTolerance = 1e-6;

// Bays of two sides and unequally spaced boards, side by side: `parts` boards without a pattern.
Assembly Shelves(int parts) {
  Assembly shelves;
  shelves.name = "shelves";
  shelves.groups = {{"shelves", -1}};
  for (int bay = 0; static_cast<int>(shelves.parts.size()) < parts; ++bay) {
    const int group = bay + 1;
    const double x = 1.0 * bay;
    const std::string name = "bay " + std::to_string(bay);
    shelves.groups.push_back({name, 0});
    shelves.parts.push_back(Board(name + " left", {x, 0, 0}, {x + 0.02, 0.3, 2}, group));
    shelves.parts.push_back(Board(name + " right", {x + 0.98, 0, 0}, {x + 1, 0.3, 2}, group));
    for (int board = 0; board < 8; ++board) {
      const double z = 0.02 * board * board + 0.11 * board;
      shelves.parts.push_back(Board(name + " board " + std::to_string(board), {x + 0.02, 0, z},
                                    {x + 0.98, 0.3, z + 0.02}, group));
    }
  }
  shelves.parts.erase(shelves.parts.begin() + parts, shelves.parts.end());
  return shelves;
}

Contacts BaysThatTouch(const std::vector<Element>& elements) {
  Contacts contacts;
  for (std::size_t a = 0; a < elements.size(); ++a) {
    for (std::size_t b = a + 1; b < elements.size(); ++b) {
      const Eigen::Vector3d overlap = elements[a].box.maximum.cwiseMin(elements[b].box.maximum) -
                                      elements[a].box.minimum.cwiseMax(elements[b].box.minimum);
      if (overlap.minCoeff() > -1e-9) {
        contacts.push_back({static_cast<int>(a), static_cast<int>(b)});
      }
    }
  }
  return contacts;
}

FeasibleSet Parametrise(const Assembly& assembly) {
  const std::vector<Element> elements = MakeElements(assembly, kTolerance);
  std::vector<Relationship> relationships =
      FindRelationships(assembly, elements, BaysThatTouch(elements), kTolerance);
  for (Relationship& held : Anchor(elements, 0)) relationships.push_back(std::move(held));
  return *FeasibleSet::Create(std::move(relationships), DrawnParameters(assembly, elements),
                              VariablesWithin(assembly, elements, 0));
}

void BM_Parametrise(benchmark::State& state) {
  const Assembly assembly = Shelves(static_cast<int>(state.range(0)));
  int degrees = 0;
  for (auto _ : state) degrees = Parametrise(assembly).degrees_of_freedom();
  state.counters["degrees_of_freedom"] = degrees;
}
BENCHMARK(BM_Parametrise)->Arg(20)->Arg(50)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);

void BM_RandomPoint(benchmark::State& state) {
  const FeasibleSet set = Parametrise(Shelves(static_cast<int>(state.range(0))));
  std::uint64_t seed = 0;
  for (auto _ : state) {
    const auto samples = set.Sample(100, ++seed);
    if (!samples.ok()) state.SkipWithError("not sampled");
  }
  state.SetItemsProcessed(100 * state.iterations());
}
BENCHMARK(BM_RandomPoint)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);

// What becomes of the design when every parameter is dragged a little.
void BM_NearestDesign(benchmark::State& state) {
  const FeasibleSet set = Parametrise(Shelves(static_cast<int>(state.range(0))));
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.1);
  Eigen::VectorXd wish = set.drawn();
  for (auto _ : state) {
    for (Eigen::Index i = 0; i < wish.size(); ++i) wish[i] = set.drawn()[i] + normal(random);
    if (!set.Nearest(wish).ok()) state.SkipWithError("not found");
  }
  state.counters["degrees_of_freedom"] = set.degrees_of_freedom();
}
BENCHMARK(BM_NearestDesign)->Arg(20)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);

// F(q): all parts, and the vertices of a mesh of 200 for each.
void BM_Evaluate(benchmark::State& state) {
  const Assembly assembly = Shelves(static_cast<int>(state.range(0)));
  const std::vector<Element> elements = MakeElements(assembly, kTolerance);
  const Eigen::VectorXd q = DrawnParameters(assembly, elements);
  mesh::DrawnShape shape;
  shape.fractions = Eigen::Matrix3Xd::Random(3, 200) / 2;
  shape.triangles = Eigen::Matrix3Xi::Zero(3, 396);
  for (auto _ : state) {
    for (const PlacedPart& part : PlaceParts(assembly, elements, q)) {
      benchmark::DoNotOptimize(SurfaceIn(shape, part.box.center(), part.stretch));
    }
  }
}
BENCHMARK(BM_Evaluate)->Arg(100)->Arg(200)->Unit(benchmark::kMillisecond);

// 200 vertices, 396 triangles and 20 faces, which look like a box: its triangles again and again.
std::shared_ptr<const mesh::DrawnShape> FinelyTriangulatedBox() {
  const mesh::SurfaceMesh box =
      SurfaceOf(BoundingBox{Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5)});
  mesh::DrawnShape shape;
  shape.fractions = box.vertices.replicate(1, 25);
  shape.triangles = box.triangles.replicate(1, 33);
  shape.triangle_face = Eigen::VectorXi::Zero(shape.triangles.cols());
  for (int face = 0; face < 20; ++face) shape.face_names.push_back({"face" + std::to_string(face)});
  return std::make_shared<const mesh::DrawnShape>(std::move(shape));
}

// F(q) as everything else takes it: a design whose parts have shapes.
void BM_EvaluateShapes(benchmark::State& state) {
  Assembly assembly = Shelves(static_cast<int>(state.range(0)));
  const auto shape = FinelyTriangulatedBox();
  for (AssemblyPart& part : assembly.parts) part.shape = shape;
  const auto parametrized = ParametricAssembly::Create(std::move(assembly));
  if (!parametrized.ok()) {
    state.SkipWithError("not parametrised");
    return;
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(DesignAt(*parametrized, parametrized->drawn(), {}, {}));
  }
}
BENCHMARK(BM_EvaluateShapes)->Arg(100)->Unit(benchmark::kMillisecond);

// ---- The whole answer ---------------------------------------------------------------------------

// A bookcase whose boards are all of different thickness, depth and height, under a rail that can
// grow by a tenth only, which its bays must share: 200 parts with about 600 sizes of their own.
Assembly UnlikeBoards() {
  constexpr int kUprights = 9, kShelvesEach = 24;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> thickness(0.012, 0.02), depth(0.2, 0.3), gap(0.06, 0.1);
  Assembly boards;
  boards.name = "boards";
  boards.groups = {{"boards", -1}};
  double x = 0;
  for (int upright = 0; upright < kUprights; ++upright) {
    const std::string name = std::to_string(upright);
    const double inside = x + 0.018 + 0.001 * upright, bay = 0.35 + 0.021 * upright;
    boards.parts.push_back(Board("upright " + name, {x, 0, 0}, {inside, 0.31, 3}, 0));
    x = inside;
    if (upright + 1 == kUprights) break;
    double z = 0.03 + 0.004 * upright;
    for (int shelf = 0; shelf < kShelvesEach && boards.parts.size() < 198; ++shelf) {
      const double top = z + thickness(random);
      boards.parts.push_back(Board("shelf " + name + " " + std::to_string(shelf), {x, 0, z},
                                   {x + bay, depth(random), top}, 0));
      z = top + gap(random);
    }
    x += bay;
  }
  boards.parts.push_back(Board("rail", {0, 0, 3}, {x, 0.02, 3.1}, 0));
  boards.parts.back().limits[0].maximum = 1.1 * x;
  return boards;
}

AssemblyPart Fastener(const std::string& name, const Eigen::Vector3d& minimum,
                      const Eigen::Vector3d& maximum, int group) {
  AssemblyPart part = Board(name, minimum, maximum, group);
  part.item = "items/fastener";
  part.connecting = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = maximum[axis] - minimum[axis];
    part.limits[static_cast<std::size_t>(axis)] = {size, size};
  }
  return part;
}

// Cupboards side by side, each as wide as no other, with shelves, rows of screws and a door on
// hinges that opens: what designs of workshops are made of. 25 parts each.
Assembly Cupboards(int count) {
  Assembly cupboards;
  cupboards.name = "cupboards";
  cupboards.groups = {{"cupboards", -1}};
  double x = 0;
  for (int k = 0; k < count; ++k) {
    const std::string name = "cupboard " + std::to_string(k) + " ";
    const double wide = 0.5 + 0.03 * k;
    const int group = static_cast<int>(cupboards.groups.size());
    cupboards.groups.push_back({name, 0});
    cupboards.groups.push_back({name + "door", group});
    const auto board = [&](const std::string& part, const Eigen::Vector3d& minimum,
                           const Eigen::Vector3d& maximum, int home) {
      cupboards.parts.push_back(Board(name + part, minimum, maximum, home));
    };
    board("left", {x, 0, 0}, {x + 0.018, 0.4, 1.8}, group);
    board("right", {x + wide - 0.018, 0, 0}, {x + wide, 0.4, 1.8}, group);
    board("back", {x, 0.4, 0}, {x + wide, 0.403, 1.8}, group);
    for (int shelf = 0; shelf < 5; ++shelf) {
      const double z = 0.05 + 0.015 * shelf * shelf + (0.25 + 0.008 * k) * shelf;
      board("shelf " + std::to_string(shelf), {x + 0.018, 0, z}, {x + wide - 0.018, 0.4, z + 0.018},
            group);
      for (int screw = 0; screw < 3; ++screw) {
        const double y = 0.1 + 0.1 * screw;
        cupboards.parts.push_back(
            Fastener(name + "screw " + std::to_string(shelf) + " " + std::to_string(screw),
                     {x, y, z + 0.007}, {x + 0.05, y + 0.004, z + 0.011}, group));
      }
    }
    board("door", {x, -0.018, 0}, {x + wide, 0, 1.8}, group + 1);
    board("handle", {x + wide - 0.06, -0.04, 0.8}, {x + wide - 0.04, -0.018, 1}, group + 1);
    Joint hinge;
    hinge.name = name + "hinge";
    hinge.kind = JointKind::kHinge;
    hinge.group = group + 1;
    hinge.center = {x, -0.018, 0.9};
    hinge.axis = Eigen::Vector3d::UnitZ();
    hinge.lower = -1.8;
    hinge.upper = 0;
    hinge.rest_poses = {{"open", {0, 0, -1.5707963267948966}}};
    cupboards.joints.push_back(hinge);
    x += wide;
  }
  return cupboards;
}

// All that somebody who opens a design waits for: patterns, contacts, relationships, feasible set,
// connections, degrees of freedom of each group and the ends of all sizes.
void ParametriseAll(benchmark::State& state, const Assembly& assembly) {
  int degrees = 0;
  for (auto _ : state) {
    const auto parametric = ParametricAssembly::Create(assembly);
    if (!parametric.ok()) {
      state.SkipWithError(std::string(parametric.status().message()).c_str());
      return;
    }
    for (int group = 0; group < static_cast<int>(assembly.groups.size()); ++group) {
      benchmark::DoNotOptimize(parametric->DegreesOfFreedom(group));
    }
    benchmark::DoNotOptimize(parametric->AdjustableSizes());
    degrees = parametric->feasible_set().degrees_of_freedom();
  }
  state.counters["parts"] = static_cast<double>(assembly.parts.size());
  state.counters["degrees_of_freedom"] = degrees;
}
void BM_WholeBookcase(benchmark::State& state) { ParametriseAll(state, Bookcase(20, 9)); }
void BM_WholeCupboards(benchmark::State& state) { ParametriseAll(state, Cupboards(8)); }
void BM_WholeLargeBookcase(benchmark::State& state) { ParametriseAll(state, Bookcase(66, 9)); }
void BM_WholeUnlikeBoards(benchmark::State& state) { ParametriseAll(state, UnlikeBoards()); }
BENCHMARK(BM_WholeUnlikeBoards)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_WholeBookcase)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_WholeLargeBookcase)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(BM_WholeCupboards)->Unit(benchmark::kMillisecond);

// Ten random designs of one that has been parametrised.
void SampleTen(benchmark::State& state, const Assembly& assembly) {
  const auto parametric = ParametricAssembly::Create(assembly);
  if (!parametric.ok()) {
    state.SkipWithError(std::string(parametric.status().message()).c_str());
    return;
  }
  std::uint64_t seed = 0;
  for (auto _ : state) {
    if (!parametric->Sample(10, ++seed).ok()) state.SkipWithError("not sampled");
  }
}
void BM_SampleBookcase(benchmark::State& state) { SampleTen(state, Bookcase(20, 9)); }
void BM_SampleCupboards(benchmark::State& state) { SampleTen(state, Cupboards(8)); }
BENCHMARK(BM_SampleBookcase)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(BM_SampleCupboards)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace mortise::parametric

BENCHMARK_MAIN();
