// What goes wrong with the shapes of maps while they are built.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <map>
#include <new>
#include <stdexcept>

#include "common/fields/fields_file.h"
#include "tests/unit/services/interpolator/building/built_shapes.h"

namespace mortise::interpolator {
namespace {

using testing::HasSubstr;

TEST(ShapeFailuresTest, HasNoShapesWhereNothingCanBeMapped) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(100, 0);
  BuildOptions options = BlockOptions(plan, shelf, 4, 4, 2);
  options.shapes->most_inverted = -1;
  const auto building = Built(plan, options);
  const ShapedStructure structure = ShapesOf(*building);
  EXPECT_THAT(structure.element_mesh, testing::Each(-1));
  EXPECT_TRUE(structure.meshes.empty());
  EXPECT_TRUE(structure.shapes.empty());
  EXPECT_THAT(building->structures()[0]->Content()->cut_off, testing::Each(1));
  const BuildProgress progress = building->progress();
  EXPECT_EQ(progress.failed, 0);
  EXPECT_EQ(progress.shapes, 0);
  EXPECT_EQ(structure.unmapped, progress.evaluations);
  EXPECT_LT(progress.evaluations, 60);
  EXPECT_EQ(progress.unmapped_failures[0].reason, "TOO_MANY_INVERTED");
}

// Leans over along x and y, so that its box is no thinner than it is wide.
void Lean(fields::DesignFields& design) {
  const auto lean = [](Eigen::Vector3d place) -> Eigen::Vector3d {
    return {place.x(), place.y(), place.z() + 0.1 * (place.x() + place.y())};
  };
  for (auto node : design.nodes.colwise()) node = lean(node);
  for (fields::ControlPoint& point : design.control_points) point.position = lean(point.position);
}

// A sheet whose elements are thinner than steps of 16 bits: mapping keeps them, rounding does not.
TEST(ShapeFailuresTest, CountsWhatRoundingTurnsOver) {
  const MapPlan plan = BlockPlan(30, 1);
  for (const double most : {1.0, 0.05}) {
    FileShelf shelf;
    BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2);
    options.shapes->most_inverted = most;
    options.evaluate = [&shelf](const std::vector<Eigen::VectorXd>& designs)
        -> absl::StatusOr<std::vector<DesignAnswer>> {
      std::vector<DesignAnswer> answers;
      for (const Eigen::VectorXd& design : designs) {
        FormulaBlock block = PlainBlock(design);
        block.size.z() = 1e-6;
        fields::DesignFields leaning = MakeBlock(block);
        Lean(leaning);
        answers.push_back({absl::OkStatus(), Eigen::VectorXd::Constant(1, design.sum()),
                           shelf.Put(fields::WriteFields(leaning).value()).value()});
      }
      return answers;
    };
    const auto building = Built(plan, options);
    const ShapedStructure structure = ShapesOf(*building);
    if (most == 1) {
      ASSERT_FALSE(structure.shapes.empty());
      for (const auto& [key, shape] : structure.shapes) EXPECT_GT(shape.inverted, 0);
    } else {
      EXPECT_TRUE(structure.shapes.empty());
      EXPECT_EQ(building->progress().unmapped_failures.at(0).reason, "TOO_MANY_INVERTED");
    }
  }
}

TEST(ShapeFailuresTest, CountsDesignsWithoutUsableShapesAsFailed) {
  const MapPlan plan = BlockPlan(60, 0);
  const std::map<std::string, std::function<void(DesignAnswer&, FileShelf&)>> faults = {
      {"FILE_MISSING", [](DesignAnswer& answer, FileShelf&) { answer.file.clear(); }},
      {"SHAPE_UNREADABLE",
       [](DesignAnswer& answer, FileShelf& shelf) {
         answer.file = shelf.Put(shelf.Get(answer.file)->substr(0, 200)).value();
       }},
      {"FIELD_MISSING", [](DesignAnswer& answer, FileShelf& shelf) {
         FormulaBlock block = PlainBlock(Eigen::Vector2d(1, 1));
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

TEST(ShapeFailuresTest, EndsWhereFilesCannotBePutOrReadOrKept) {
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

// Files come from the evaluator, so they cannot be got any more after it has been interrupted.
TEST(ShapeFailuresTest, HasAMapOfWhatWasSampledWhereStoppingInterruptsFiles) {
  const MapPlan plan = BlockPlan(80, 1);
  for (const int threads : {1, 3}) {
    FileShelf shelf;
    BuildOptions options = BlockOptions(plan, shelf, 2, 3, threads);
    options.shapes->memory = 0;
    Keeper keeper;
    keeper.KeepFor(options);
    std::atomic<bool> is_enough = false, is_interrupted = false;
    options.cancelled = [&] {
      if (keeper.shapes.differences.size() >= 20) is_enough = true;
      return is_enough.load();
    };
    options.interrupt = [&] {
      is_interrupted = true;
      is_interrupted.notify_all();
    };
    options.shapes->get =
        [&, get = options.shapes->get](const std::string& digest) -> absl::StatusOr<std::string> {
      if (!is_enough) return get(digest);
      is_interrupted.wait(false);
      return absl::CancelledError("interrupted");
    };
    const auto building = Built(plan, options);
    EXPECT_EQ(building->ReasonOf(0), StopReason::kCancelled);
    EXPECT_FALSE(ShapesOf(*building).meshes.empty());
  }
}

TEST(ShapeFailuresTest, SaysWhyNoMeshCanBeMade) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(40, 1);
  BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2);
  options.shapes->fields.clear();
  options.evaluate = [&](const std::vector<Eigen::VectorXd>& designs)
      -> absl::StatusOr<std::vector<DesignAnswer>> {
    std::vector<DesignAnswer> answers;
    for (const Eigen::VectorXd& design : designs) {
      // What two parts have between them, and no outside.
      fields::DesignFields inside;
      inside.nodes = (1 + design.sum()) * Eigen::Matrix3d::Identity();
      inside.tetrahedra.resize(4, 0);
      inside.triangles = Eigen::Vector3i(0, 1, 2);
      inside.triangle_back = Eigen::VectorXi::Constant(1, 0);
      inside.triangle_front = Eigen::VectorXi::Constant(1, 1);
      inside.parts = {"one", "other"};
      DesignAnswer& answer = answers.emplace_back();
      answer.values = Eigen::VectorXd::Constant(1, design.sum());
      answer.file = shelf.Put(fields::WriteFields(inside).value()).value();
    }
    return answers;
  };
  Keeper keeper;
  keeper.KeepFor(options);
  const auto expect_reasons = [](const MapBuilding& building) {
    EXPECT_THAT(ShapesOf(building).element_mesh, testing::Each(-1));
    const BuildProgress progress = building.progress();
    EXPECT_EQ(progress.failed, 0);
    EXPECT_GT(progress.unmapped, 0);
    ASSERT_EQ(progress.unmapped_failures.size(), 1U);
    EXPECT_EQ(progress.unmapped_failures[0].count, progress.unmapped);
    EXPECT_THAT(progress.unmapped_failures[0].message, HasSubstr("on the outside"));
  };
  const auto first = Built(plan, options);
  expect_reasons(*first);
  const KnownAnswers answers = keeper.answers;
  const KnownShapes shapes = keeper.shapes;
  const auto again = Built(plan, options, answers, shapes);
  expect_reasons(*again);
  EXPECT_EQ(again->progress().unmapped, first->progress().unmapped);
}

// Want of memory tells nothing of a design's topology, and must not be kept as if it did.
TEST(ShapeFailuresTest, EndsWhereThereIsTooLittleMemoryToMap) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(40, 0);
  BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2, [](const Eigen::VectorXd& design) {
    FormulaBlock block = PlainBlock(design);
    block.cells = design[0] > 0.6 ? 4 : 3;
    return block;
  });
  options.shapes->mapping.volume.memory_limit = 1;
  Keeper keeper;
  keeper.KeepFor(options);
  const absl::Status status = MapBuilding::Create(plan, options).value()->Run({});
  EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
  for (const auto& [key, shape] : keeper.shapes.shapes) EXPECT_TRUE(shape.status.ok());
}

TEST(ShapeFailuresTest, EndsWhereWorkThrows) {
  const MapPlan plan = BlockPlan(40, 0);
  const auto run = [&plan](const std::function<void(BuildOptions&)>& spoil) {
    FileShelf shelf;
    BuildOptions options = BlockOptions(plan, shelf, 2, 3, 2);
    spoil(options);
    return MapBuilding::Create(plan, options).value()->Run({});
  };
  const absl::Status of_lane = run([](BuildOptions& options) {
    options.evaluate = [](const auto&) -> absl::StatusOr<std::vector<DesignAnswer>> {
      throw std::runtime_error("no answer");
    };
  });
  EXPECT_TRUE(absl::IsInternal(of_lane)) << of_lane;
  EXPECT_THAT(of_lane.message(), HasSubstr("no answer"));
  const absl::Status of_shapes = run([](BuildOptions& options) {
    options.shapes->put = [](const std::string&) -> absl::StatusOr<std::string> {
      throw std::runtime_error("no disk");
    };
  });
  EXPECT_TRUE(absl::IsInternal(of_shapes)) << of_shapes;
  EXPECT_THAT(of_shapes.message(), HasSubstr("no disk"));
  EXPECT_TRUE(absl::IsResourceExhausted(run([](BuildOptions& options) {
    options.shapes->put = [](const std::string&) -> absl::StatusOr<std::string> {
      throw std::bad_alloc();
    };
  })));
}

TEST(ShapeFailuresTest, AsksAgainWhereAKnownAnswerHasNoShape) {
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

TEST(ShapeFailuresTest, RefusesWhatWasKeptOfAnotherMap) {
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
