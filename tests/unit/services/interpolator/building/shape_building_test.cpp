// Building maps with shapes and fields, and what goes wrong with them.
#include "services/interpolator/building/shape_building.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "common/base/errors.h"
#include "common/base/random.h"
#include "common/fields/fields_file.h"
#include "common/maps/interpolation_map.h"
#include "common/maps/packed_weights.h"
#include "services/interpolator/building/map_building.h"
#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/shape_file.h"
#include "tests/unit/services/interpolator/building/block_designs.h"

namespace mortise::interpolator {
namespace {

using testing::HasSubstr;

std::unique_ptr<MapBuilding> Built(const MapPlan& plan, const BuildOptions& options,
                                   const KnownAnswers& known = {}, KnownShapes shapes = {}) {
  auto building = MapBuilding::Create(plan, options).value();
  const absl::Status status = building->Run(known, std::move(shapes));
  EXPECT_TRUE(status.ok()) << status;
  return building;
}

ShapedStructure ShapesOf(const MapBuilding& building) {
  auto shapes = building.ShapesOf(0);
  EXPECT_TRUE(shapes.ok()) << shapes.status();
  return **shapes;
}

void ExpectSame(const Spread& a, const Spread& b) {
  EXPECT_EQ(a.largest, b.largest);
  EXPECT_EQ(a.of_99, b.of_99);
  EXPECT_EQ(a.mean, b.mean);
}

void ExpectSame(const ShapedStructure::Errors& a, const ShapedStructure::Errors& b) {
  ExpectSame(a.shape, b.shape);
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (std::size_t f = 0; f < a.fields.size(); ++f) ExpectSame(a.fields[f], b.fields[f]);
}

void ExpectSame(const MapBuilding& a, const MapBuilding& b) {
  const maps::MapContent first = a.structures()[0]->Content().value();
  const maps::MapContent second = b.structures()[0]->Content().value();
  EXPECT_EQ(first.splits, second.splits);
  EXPECT_EQ(first.values, second.values);
  EXPECT_EQ(first.errors, second.errors);
  EXPECT_EQ(first.cut_off, second.cut_off);
  const ShapedStructure shapes = ShapesOf(a), others = ShapesOf(b);
  EXPECT_EQ(shapes.element_mesh, others.element_mesh);
  ASSERT_EQ(shapes.meshes.size(), others.meshes.size());
  for (std::size_t m = 0; m < shapes.meshes.size(); ++m) {
    EXPECT_EQ(shapes.meshes[m].digest, others.meshes[m].digest);
  }
  ASSERT_EQ(shapes.shapes.size(), others.shapes.size());
  for (const auto& [key, shape] : shapes.shapes) {
    EXPECT_EQ(shape.digest, others.shapes.at(key).digest);
  }
  ASSERT_EQ(shapes.element_errors.size(), others.element_errors.size());
  for (std::size_t e = 0; e < shapes.element_errors.size(); ++e) {
    ExpectSame(shapes.element_errors[e], others.element_errors[e]);
  }
  ExpectSame(shapes.largest, others.largest);
  ExpectSame(shapes.mean, others.mean);
  EXPECT_EQ(shapes.unmapped, others.unmapped);
}

// What a build hands over to be kept, each thing once.
struct Keeper {
  KnownAnswers answers;
  KnownShapes shapes;

  void KeepFor(BuildOptions& options) {
    options.keep = [this](const KnownAnswers& fresh) {
      for (const auto& [key, answer] : fresh) EXPECT_TRUE(answers.emplace(key, answer).second);
      return absl::OkStatus();
    };
    options.shapes->keep = [this](const KnownShapes& fresh) {
      for (const auto& each : fresh.meshes) EXPECT_TRUE(shapes.meshes.insert(each).second);
      for (const auto& each : fresh.shapes) EXPECT_TRUE(shapes.shapes.insert(each).second);
      for (const auto& each : fresh.differences) {
        EXPECT_TRUE(shapes.differences.insert(each).second);
      }
      return absl::OkStatus();
    };
  }
};

// A map as it is served.
class ServedShapes {
 public:
  ServedShapes(const MapBuilding& building, const FileShelf& shelf)
      : map_(*maps::InterpolationMap::Create(*building.structures()[0]->Content())),
        weights_(map_.tree()),
        structure_(ShapesOf(building)) {
    for (const ShapedStructure::Mesh& mesh : structure_.meshes) {
      meshes_.push_back(ReadMesh(shelf.Get(mesh.digest).value()).value());
    }
    for (const auto& [key, shape] : structure_.shapes) {
      shapes_[key] = ReadShape(shelf.Get(shape.digest).value(), meshes_[key.first]).value();
    }
    int order = 0;
    for (const int element : map_.tree().Elements()) order_[element] = order++;
  }

  int MeshAt(const Eigen::VectorXd& point) const {
    return structure_.element_mesh[order_.at(map_.tree().Locate(point))];
  }
  const CanonicalMesh& mesh(int number) const { return meshes_[number]; }
  const ShapedStructure& structure() const { return structure_; }

  BlendedShape At(const Eigen::VectorXd& point) const {
    std::vector<maps::SampleWeight> weights;
    weights_.At(point.data(), weights);
    const int mesh = MeshAt(point);
    std::vector<WeightedShape> shapes;
    for (const maps::SampleWeight& each : weights) {
      shapes.push_back({&shapes_.at({mesh, each.sample}), each.weight});
    }
    BlendedShape blended;
    EXPECT_TRUE(
        Blend(shapes, meshes_[mesh], {.surface_only = false, .fields = {0, 1}}, blended).ok());
    return blended;
  }

 private:
  maps::InterpolationMap map_;
  maps::PackedWeights weights_;
  ShapedStructure structure_;
  std::vector<CanonicalMesh> meshes_;
  std::map<std::pair<int, int>, PackedShape> shapes_;
  std::map<int, std::size_t> order_;
};

TEST(ShapeBuildingTest, MakesTheSameMapWithAnyNumberOfCallsAndThreads) {
  FileShelf shelf;
  for (const int metrics : {0, 1}) {
    const MapPlan plan = BlockPlan(60, metrics);
    const BuildOptions one = BlockOptions(plan, shelf, 1, 1, 1);
    const auto first = Built(plan, one);
    for (const int many : {2, 5}) {
      const BuildOptions options = BlockOptions(plan, shelf, many, 2 * many - 1, many);
      ExpectSame(*first, *Built(plan, options));
    }
    EXPECT_EQ(first->structures()[0]->Content()->cut_off,
              std::vector<std::uint8_t>(ShapesOf(*first).element_mesh.size(), 0));
    EXPECT_EQ(ShapesOf(*first).meshes.size(), 1U);
  }
}

TEST(ShapeBuildingTest, InterpolatesShapesAndFieldsAsWellAsItSays) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(400, 0);
  BuildOptions options = BlockOptions(plan, shelf, 4, 4, 2);
  options.sampling.tolerance = 0.02;
  const auto building = Built(plan, options);
  EXPECT_EQ(building->ReasonOf(0), StopReason::kConverged);
  const BuildProgress progress = building->progress();
  EXPECT_LE(progress.error, 0.02);
  EXPECT_EQ(progress.meshes, 1);
  EXPECT_EQ(progress.shapes, progress.evaluations);
  EXPECT_EQ(progress.to_map, 0);
  EXPECT_EQ(progress.unmapped, 0);

  const ServedShapes served(*building, shelf);
  const ShapedStructure& structure = served.structure();
  ASSERT_EQ(structure.fields.size(), 2U);
  EXPECT_EQ(structure.meshes[0].regions, std::vector<std::string>{"top"});
  for (const int field : {0, 1}) {
    EXPECT_GT(structure.largest.fields[field].of_99, 0);
    EXPECT_LE(structure.largest.fields[field].of_99, 0.02 * structure.ranges[field].length());
    EXPECT_LE(structure.mean.fields[field].mean, structure.largest.fields[field].mean);
  }
  // Lengths are linear in x and y.
  EXPECT_LT(structure.largest.shape.largest, 1e-4);
  Random random(7);
  for (int n = 0; n < 40; ++n) {
    const Eigen::Vector2d point(random.Uniform(), random.Uniform());
    const BlendedShape blended = served.At(point);
    const fields::DesignFields truth = MakeBlock(PlainBlock(point));
    const CanonicalMesh& mesh = served.mesh(0);
    for (int node = 0; node < mesh.node_count(); ++node) {
      const int given = mesh.given_node[node];
      for (int d = 0; d < 3; ++d) {
        EXPECT_NEAR(blended.positions[3 * node + d], truth.nodes(d, given), 1e-4);
      }
      const auto f = mesh.FindField("temperature", "");
      EXPECT_NEAR(blended.fields[f][node], truth.fields[0].values(0, given),
                  0.04 * structure.ranges[f].length());
    }
  }
}

// Temperature bends along y alone, stress along x: what is asked for decides.
TEST(ShapeBuildingTest, SplitsAlongWhatBends) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(60, 0);
  for (const int along : {0, 1}) {
    const BuildOptions options =
        BlockOptions(plan, shelf, 4, 4, 2, [along](const Eigen::VectorXd& design) {
          BlockDesign block = PlainBlock(design);
          if (along == 0) block.temperature = [](const Eigen::Vector3d& at) { return at.sum(); };
          if (along == 1) block.stress = [](const Eigen::Vector3d& at) { return at.sum(); };
          return block;
        });
    const auto building = Built(plan, options);
    int splits = 0, others = 0;
    for (const maps::ElementSplit& split : building->structures()[0]->tree().history()) {
      ++(split.direction == along ? splits : others);
    }
    EXPECT_GT(splits, 3 * others);
  }
}

TEST(ShapeBuildingTest, DoesNotChaseWhatIsBelowNoiseFloors) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(200, 0);
  const auto noisy = [](const Eigen::VectorXd& design) {
    BlockDesign block = PlainBlock(design);
    const double noise = std::sin(1e4 * design[0] + 3e4 * design[1]);
    block.size.z() += 0.002 * noise;
    block.temperature = [design, noise](const Eigen::Vector3d&) { return design[0] + .02 * noise; };
    block.stress = [](const Eigen::Vector3d& at) { return at.sum(); };
    return block;
  };
  BuildOptions options = BlockOptions(plan, shelf, 4, 4, 2, noisy);
  options.sampling.tolerance = 1e-3;
  EXPECT_EQ(Built(plan, options)->ReasonOf(0), StopReason::kBudget);
  options.shapes->noise_floor = 0.01;
  options.shapes->fields = {{"temperature", 0.1}, {"stress", 0}};
  const auto calm = Built(plan, options);
  EXPECT_EQ(calm->ReasonOf(0), StopReason::kConverged);
  EXPECT_LT(calm->progress().evaluations, 50);
}

TEST(ShapeBuildingTest, MapsDesignsOfOtherElements) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(25, 0);
  const BuildOptions options =
      BlockOptions(plan, shelf, 4, 4, 2, [](const Eigen::VectorXd& design) {
        BlockDesign block = PlainBlock(design);
        block.cells = design[0] > 0.6 ? 4 : 3;
        return block;
      });
  const auto building = Built(plan, options);
  EXPECT_EQ(building->progress().meshes, 1);
  EXPECT_EQ(building->progress().unmapped, 0);
  const ServedShapes served(*building, shelf);
  EXPECT_LT(served.structure().largest.shape.of_99, 0.02);
}

BlockDesign HoleBeyond(const Eigen::VectorXd& design) {
  BlockDesign block = PlainBlock(design);
  block.has_hole = design[0] > 0.6;
  return block;
}

TEST(ShapeBuildingTest, GivesMeshesOfTheirOwnToWhatHasAnotherTopology) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(120, 0);
  const BuildOptions options = BlockOptions(plan, shelf, 4, 4, 2, HoleBeyond);
  const auto building = Built(plan, options);
  const ServedShapes served(*building, shelf);
  EXPECT_EQ(served.structure().meshes.size(), 2U);
  const BuildProgress progress = building->progress();
  EXPECT_EQ(progress.meshes, 2);
  EXPECT_GT(progress.unmapped, 0);
  ASSERT_EQ(progress.unmapped_failures.size(), 1U);
  EXPECT_EQ(progress.unmapped_failures[0].reason, "TOPOLOGY_DIFFERS");
  EXPECT_EQ(progress.unmapped_failures[0].count, progress.unmapped);
  int lost = 0;
  Random random(3);
  for (int n = 0; n < 500; ++n) {
    const Eigen::Vector2d point(random.Uniform(), random.Uniform());
    const int mesh = served.MeshAt(point);
    if (mesh < 0) {
      ++lost;
      EXPECT_NEAR(point[0], 0.6, 0.125);
    } else {
      EXPECT_EQ(served.mesh(mesh).element_count(), MakeBlock(HoleBeyond(point)).tetrahedra.cols());
    }
  }
  EXPECT_GT(lost, 10);
  // What is cut off is only along x: the hole does not depend on y.
  const maps::RefinementTree& tree = building->structures()[0]->tree();
  for (const int element : tree.Elements()) {
    if (!building->structures()[0]->IsCutOff(element)) continue;
    EXPECT_LE(tree.DepthOf(element, 1), 2);
  }
  const BuildOptions one = BlockOptions(plan, shelf, 1, 1, 1, HoleBeyond);
  ExpectSame(*building, *Built(plan, one));
}

TEST(ShapeBuildingTest, CutsOffAllWhereNothingCanBeMapped) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(100, 0);
  BuildOptions options = BlockOptions(plan, shelf, 4, 4, 2);
  options.shapes->most_inverted = -1;
  const auto building = Built(plan, options);
  const ShapedStructure structure = ShapesOf(*building);
  EXPECT_THAT(structure.element_mesh, testing::Each(-1));
  EXPECT_TRUE(structure.meshes.empty());
  EXPECT_TRUE(structure.shapes.empty());
  const BuildProgress progress = building->progress();
  EXPECT_EQ(progress.failed, 0);
  EXPECT_EQ(progress.shapes, 0);
  EXPECT_EQ(structure.unmapped, progress.evaluations);
  EXPECT_LT(progress.evaluations, 60);
  EXPECT_EQ(progress.unmapped_failures[0].reason, "TOO_MANY_INVERTED");
}

TEST(ShapeBuildingTest, GivesEachStructureMeshesOfItsOwn) {
  FileShelf shelf;
  MapPlan plan = BlockPlan(60, 1);
  plan.names.push_back("holes");
  plan.base = Eigen::Vector3d(0, 0, 0);
  plan.parameters.push_back({.name = "holes", .unit = "1", .index = 2, .minimum = 0, .maximum = 1});
  plan.parameters[2].whole = true;
  plan.parameters[2].values = {0, 1};
  plan.structures.resize(1, 2);
  plan.structures << 0, 1;
  const auto holes = [](const Eigen::VectorXd& design) {
    BlockDesign block = PlainBlock(design);
    block.has_hole = design[2] == 1;
    return block;
  };
  const BuildOptions options = BlockOptions(plan, shelf, 3, 2, 2, holes);
  const auto building = Built(plan, options);
  std::vector<std::int64_t> tetrahedra;
  for (const std::size_t structure : {0, 1}) {
    const auto shapes = building->ShapesOf(structure);
    ASSERT_TRUE(shapes.ok());
    ASSERT_EQ((*shapes)->meshes.size(), 1U);
    tetrahedra.push_back((*shapes)->meshes[0].tetrahedra);
    EXPECT_THAT((*shapes)->element_mesh, testing::Each(0));
    EXPECT_EQ((*shapes)->unmapped, 0);
  }
  EXPECT_EQ(tetrahedra, (std::vector<std::int64_t>{108, 96}));
}

TEST(ShapeBuildingTest, GoesOnFromWhatWasKept) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(80, 1);
  BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2, HoleBeyond);
  const auto reference = Built(plan, options);
  Keeper all;
  all.KeepFor(options);
  Built(plan, options);

  for (const std::size_t enough : {3, 20, 60, 90}) {
    Keeper keeper;
    keeper.KeepFor(options);
    options.cancelled = [&] {
      return keeper.answers.size() + keeper.shapes.shapes.size() >= enough;
    };
    const auto interrupted = MapBuilding::Create(plan, options).value();
    ASSERT_TRUE(interrupted->Run({}).ok());
    EXPECT_EQ(interrupted->ReasonOf(0), StopReason::kCancelled);
    const KnownAnswers answers = keeper.answers;
    const KnownShapes shapes = keeper.shapes;
    options.cancelled = nullptr;
    // The keeper checks that nothing is found out twice.
    ExpectSame(*reference, *Built(plan, options, answers, shapes));
    EXPECT_EQ(keeper.answers.size(), all.answers.size());
    EXPECT_EQ(keeper.shapes.shapes.size(), all.shapes.shapes.size());
    EXPECT_EQ(keeper.shapes.differences.size(), all.shapes.differences.size());
  }
}

TEST(ShapeBuildingTest, FindsOutNothingWhereAllIsKnown) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(50, 1);
  BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2);
  Keeper keeper;
  keeper.KeepFor(options);
  const auto first = Built(plan, options);
  const int puts = shelf.puts();
  options.evaluate = [](const auto&) { return absl::UnavailableError("away"); };
  const KnownAnswers answers = keeper.answers;
  const KnownShapes shapes = keeper.shapes;
  ExpectSame(*first, *Built(plan, options, answers, shapes));
  EXPECT_EQ(shelf.puts(), puts);
}

// Whatever the moment, what there is belongs together.
TEST(ShapeBuildingTest, HasShapesOfAllElementsWhereverItIsStopped) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(80, 0);
  for (const std::size_t enough : {8, 15, 25, 40, 70}) {
    BuildOptions options = BlockOptions(plan, shelf, 2, 2, 2, HoleBeyond);
    Keeper keeper;
    keeper.KeepFor(options);
    options.cancelled = [&] { return keeper.shapes.shapes.size() >= enough; };
    const auto building = Built(plan, options);
    if (!building->structures()[0]->Content().ok()) {
      EXPECT_EQ(DetailOf(building->ShapesOf(0).status()).reason, "MAP_NOT_SAMPLED");
      continue;
    }
    const ServedShapes served(*building, shelf);
    Random random(3);
    for (int n = 0; n < 50; ++n) {
      const Eigen::Vector2d point(random.Uniform(), random.Uniform());
      if (served.MeshAt(point) < 0) continue;
      EXPECT_GT(served.At(point).node_count(), 0);
    }
  }
}

TEST(ShapeBuildingTest, CountsDesignsWithoutUsableShapesAsFailed) {
  const MapPlan plan = BlockPlan(60, 0);
  const std::map<std::string, std::function<void(DesignAnswer&, FileShelf&)>> faults = {
      {"FILE_MISSING", [](DesignAnswer& answer, FileShelf&) { answer.file.clear(); }},
      {"SHAPE_UNREADABLE",
       [](DesignAnswer& answer, FileShelf& shelf) {
         answer.file = shelf.Put(shelf.Get(answer.file)->substr(0, 200)).value();
       }},
      {"FIELD_MISSING", [](DesignAnswer& answer, FileShelf& shelf) {
         BlockDesign block = PlainBlock(Eigen::Vector2d(1, 1));
         block.stress = nullptr;
         answer.file = shelf.Put(fields::WriteFields(MakeBlock(block)).value()).value();
       }}};
  for (const auto& [reason, spoil] : faults) {
    FileShelf shelf;
    BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2);
    options.evaluate = [&, good = options.evaluate,
                        spoil = spoil](const std::vector<Eigen::VectorXd>& designs) {
      auto answers = good(designs);
      for (std::size_t n = 0; n < designs.size(); ++n) {
        if (designs[n][0] > 0.9) spoil((*answers)[n], shelf);
      }
      return answers;
    };
    const auto building = Built(plan, options);
    const BuildProgress progress = building->progress();
    ASSERT_EQ(progress.failures.size(), 1U);
    EXPECT_EQ(progress.failures[0].reason, reason);
    const ServedShapes served(*building, shelf);
    EXPECT_EQ(served.MeshAt(Eigen::Vector2d(0.99, 0.5)), -1);
    EXPECT_EQ(served.MeshAt(Eigen::Vector2d(0.3, 0.5)), 0);
  }
}

TEST(ShapeBuildingTest, EndsWhereFilesCannotBePutOrReadOrKept) {
  const MapPlan plan = BlockPlan(60, 0);
  const auto run = [&](const std::function<void(ShapeOptions&)>& spoil) {
    FileShelf shelf;
    BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2);
    spoil(*options.shapes);
    return MapBuilding::Create(plan, options).value()->Run({});
  };
  std::atomic<int> puts = 0;
  const absl::Status full = run([&](ShapeOptions& shapes) {
    shapes.put = [&, put = shapes.put](const std::string& bytes) -> absl::StatusOr<std::string> {
      if (++puts > 10) return absl::ResourceExhaustedError("the disk is full");
      return put(bytes);
    };
  });
  EXPECT_TRUE(absl::IsResourceExhausted(full)) << full;
  EXPECT_TRUE(absl::IsInternal(run([](ShapeOptions& shapes) {
    shapes.keep = [](const KnownShapes&) { return absl::InternalError("no store"); };
  })));
  std::atomic<int> gets = 0;
  EXPECT_TRUE(absl::IsNotFound(run([&](ShapeOptions& shapes) {
    shapes.memory = 0;
    shapes.get = [&, get = shapes.get](const std::string& digest) -> absl::StatusOr<std::string> {
      if (++gets > 20) return absl::NotFoundError("gone");
      return get(digest);
    };
  })));
}

TEST(ShapeBuildingTest, AsksAgainWhereAKnownAnswerHasNoShape) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(40, 1);
  BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2);
  Keeper keeper;
  keeper.KeepFor(options);
  const auto first = Built(plan, options);
  KnownAnswers old = keeper.answers;
  for (auto& [key, answer] : old) answer.file.clear();
  options.keep = nullptr;
  options.shapes->keep = nullptr;
  ExpectSame(*first, *Built(plan, options, old));
}

TEST(ShapeBuildingTest, RefusesWhatWasKeptOfAnotherMap) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(40, 1);
  BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2);
  Keeper keeper;
  keeper.KeepFor(options);
  Built(plan, options);
  KnownShapes wrong = keeper.shapes;
  wrong.meshes.begin()->second.number += 1;
  const absl::Status status =
      MapBuilding::Create(plan, options).value()->Run(KnownAnswers(keeper.answers), wrong);
  EXPECT_TRUE(absl::IsDataLoss(status)) << status;
  EXPECT_THAT(status.message(), HasSubstr("another map"));
}

}  // namespace
}  // namespace mortise::interpolator
