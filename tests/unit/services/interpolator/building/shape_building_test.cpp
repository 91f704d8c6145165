// Building maps with shapes and fields.
#include "services/interpolator/building/shape_building.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/base/errors.h"
#include "common/base/random.h"
#include "tests/unit/services/interpolator/building/built_shapes.h"

namespace mortise::interpolator {
namespace {

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
  EXPECT_EQ(structure.meshes[0].regions, std::vector<std::string>{"held"});
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
          FormulaBlock block = PlainBlock(design);
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
    FormulaBlock block = PlainBlock(design);
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
        FormulaBlock block = PlainBlock(design);
        block.cells = design[0] > 0.6 ? 4 : 3;
        return block;
      });
  const auto building = Built(plan, options);
  EXPECT_EQ(building->progress().meshes, 1);
  EXPECT_EQ(building->progress().unmapped, 0);
  const ServedShapes served(*building, shelf);
  EXPECT_LT(served.structure().largest.shape.of_99, 0.02);
}

FormulaBlock HoleBeyond(const Eigen::VectorXd& design) {
  FormulaBlock block = PlainBlock(design);
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
  // What has no shape is made small only along x: the hole does not depend on y.
  const maps::MapContent content = building->structures()[0]->Content().value();
  const auto tree = maps::RefinementTree::Replay(2, content.basis, content.options, content.splits);
  std::size_t order = 0;
  for (const int element : tree->Elements()) {
    // Without metrics there is nothing where there is no shape.
    const bool is_shapeless = served.structure().element_mesh[order] < 0;
    EXPECT_EQ(content.cut_off[order++] != 0, is_shapeless);
    if (!is_shapeless) continue;
    EXPECT_LE(tree->DepthOf(element, 1), 2);
  }
  const BuildOptions one = BlockOptions(plan, shelf, 1, 1, 1, HoleBeyond);
  ExpectSame(*building, *Built(plan, one));
}

TEST(ShapeBuildingTest, HasMetricsWhereItHasNoShapes) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(120, 1);
  const BuildOptions options = BlockOptions(plan, shelf, 4, 4, 2, HoleBeyond);
  const auto building = Built(plan, options);
  const ServedShapes served(*building, shelf);
  const auto map = *maps::InterpolationMap::Create(*building->structures()[0]->Content());
  int shapeless = 0;
  Random random(3);
  for (int n = 0; n < 500; ++n) {
    const Eigen::Vector2d point(random.Uniform(), random.Uniform());
    double value = 0, error = 0;
    ASSERT_TRUE(map.EvaluateOne(point.data(), &value, &error, nullptr));
    const auto truth = options.evaluate({point});
    EXPECT_NEAR(value, truth->front().values[0], 0.05);
    shapeless += served.MeshAt(point) < 0 ? 1 : 0;
  }
  EXPECT_GT(shapeless, 10);
  EXPECT_GT(served.structure().unmapped, 0);
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
    FormulaBlock block = PlainBlock(design);
    block.has_hole = design[2] == 1;
    return block;
  };
  const BuildOptions options = BlockOptions(plan, shelf, 3, 2, 2, holes);
  const auto building = Built(plan, options);
  for (const std::size_t structure : {0, 1}) {
    const auto shapes = building->ShapesOf(structure);
    ASSERT_TRUE(shapes.ok());
    ASSERT_EQ((*shapes)->meshes.size(), 1U);
    const Eigen::Vector3d design(0.5, 0.5, static_cast<double>(structure));
    EXPECT_EQ((*shapes)->meshes[0].tetrahedra, MakeBlock(holes(design)).tetrahedra.cols());
    EXPECT_THAT((*shapes)->element_mesh, testing::Each(0));
    EXPECT_EQ((*shapes)->unmapped, 0);
  }
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

TEST(ShapeBuildingTest, HasAllThatIsKnownWhereItIsStoppedAtOnce) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(80, 1);
  BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2, HoleBeyond);
  Keeper keeper;
  keeper.KeepFor(options);
  const auto first = Built(plan, options);
  const KnownAnswers answers = keeper.answers;
  KnownShapes shapes = keeper.shapes;
  options.cancelled = [] { return true; };
  ExpectSame(*first, *Built(plan, options, answers, shapes));
  options.cancelled = nullptr;
  options.is_out_of_time = [] { return true; };
  ExpectSame(*first, *Built(plan, options, answers, shapes));
  options.is_out_of_time = nullptr;

  // Nothing is found out before it is asked whether to stop.
  shapes.differences.clear();
  options.cancelled = [] { return true; };
  options.shapes->put = [](const std::string&) { return absl::InternalError("not to be called"); };
  const auto stopped = Built(plan, options, answers, shapes);
  EXPECT_EQ(stopped->ReasonOf(0), StopReason::kCancelled);
  EXPECT_EQ(stopped->progress().to_map, 0);
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
    EXPECT_EQ(served.structure().ranges.size(), served.structure().fields.size());
    Random random(3);
    for (int n = 0; n < 50; ++n) {
      const Eigen::Vector2d point(random.Uniform(), random.Uniform());
      if (served.MeshAt(point) < 0) continue;
      EXPECT_GT(served.At(point).node_count(), 0);
    }
  }
}

// The first round cuts all off, and the second is stopped where it has a mesh and no ranges yet.
TEST(ShapeBuildingTest, HasNoFieldsBeforeARoundHasThemAll) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(80, 0);
  BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2, HoleBeyond);
  Keeper keeper;
  keeper.KeepFor(options);
  Built(plan, options);
  const KnownAnswers answers = keeper.answers;
  KnownShapes shapes = keeper.shapes;
  shapes.differences.clear();
  options.cancelled = [] { return true; };
  const auto building = Built(plan, options, answers, shapes);
  const ShapedStructure structure = ShapesOf(*building);
  EXPECT_THAT(structure.element_mesh, testing::Each(-1));
  EXPECT_TRUE(structure.fields.empty());
  EXPECT_TRUE(structure.ranges.empty());
  EXPECT_TRUE(structure.largest.fields.empty());
  EXPECT_TRUE(structure.mean.fields.empty());
}

}  // namespace
}  // namespace mortise::interpolator
