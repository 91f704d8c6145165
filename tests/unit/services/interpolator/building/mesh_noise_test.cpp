// Noise floors that are estimated by one design on two meshes.
#include "services/interpolator/building/mesh_noise.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

#include "common/base/errors.h"
#include "common/fields/fields_file.h"
#include "tests/unit/services/interpolator/building/built_shapes.h"
#include "tests/unit/services/interpolator/building/example_plan.h"

namespace mortise::interpolator {
namespace {

// The product is exact, the sum is not; what else it says depends on the design alone.
class MetricNoiseTest : public ::testing::Test {
 protected:
  static DesignAnswer AnswerOf(const Eigen::VectorXd& design) {
    return {absl::OkStatus(), Eigen::Vector2d(std::sin(3 * design[0]) + design[2] + design[3],
                                              std::exp(design[0]) * design[2] * design[3])};
  }

  BuildOptions Options(int lanes) {
    BuildOptions options;
    options.lanes = lanes;
    options.sampling.tolerance = 1e-9;
    options.evaluate = [this](const std::vector<Eigen::VectorXd>& designs) {
      evaluated_ += static_cast<int>(designs.size());
      std::vector<DesignAnswer> answers;
      for (const Eigen::VectorXd& design : designs) answers.push_back(AnswerOf(design));
      return answers;
    };
    MeshNoiseOptions noise;
    noise.of_metrics = {true, true};
    noise.evaluate = [this](const Eigen::VectorXd& design) {
      ++on_other_meshes_;
      middle_ = design;
      DesignAnswer answer = AnswerOf(design);
      answer.values[0] -= 0.25;
      return answer;
    };
    noise.keep = [this](const MeshNoise& found) {
      kept_ = found;
      return absl::OkStatus();
    };
    options.noise = std::move(noise);
    return options;
  }

  std::atomic<int> evaluated_ = 0, on_other_meshes_ = 0;
  Eigen::VectorXd middle_;
  std::optional<MeshNoise> kept_;
};

TEST_F(MetricNoiseTest, IsWhatTheDesignInTheMiddleDiffersBy) {
  const MapPlan plan = ExamplePlan(101);
  const BuildOptions options = Options(1);
  const auto building = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(building->Run({}).ok());
  EXPECT_EQ(on_other_meshes_, 1);
  EXPECT_EQ(middle_, Eigen::Vector4d(0.5, 7, 1, 11));
  ASSERT_EQ(building->noise().metrics.size(), 2u);
  EXPECT_NEAR(*building->noise().metrics[0], 0.25, 1e-12);
  EXPECT_EQ(*building->noise().metrics[1], 0);
  // It counts in the budget, which is all of it.
  EXPECT_LE(evaluated_ + on_other_meshes_, 101);
  EXPECT_EQ(building->progress().evaluations, evaluated_ + on_other_meshes_);
  ASSERT_TRUE(kept_.has_value());
  EXPECT_EQ(kept_->metrics, building->noise().metrics);
}

// Whoever watches sees designs come while nothing is decided by them.
TEST_F(MetricNoiseTest, DesignsCountBeforeItIsKnown) {
  const MapPlan plan = ExamplePlan(101);
  BuildOptions options = Options(1);
  std::vector<BuildProgress> told;
  options.progress = [&](const BuildProgress& progress) { told.push_back(progress); };
  const auto building = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(building->Run({}).ok());
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.front().evaluations, 1);
  for (std::size_t i = 1; i < told.size(); ++i) {
    EXPECT_GE(told[i].evaluations, told[i - 1].evaluations);
  }
}

TEST_F(MetricNoiseTest, ActsAsFloorsThatAreGiven) {
  const MapPlan plan = ExamplePlan(401);
  const BuildOptions estimated = Options(1);
  BuildOptions given = Options(1);
  given.noise.reset();
  const auto building = MapBuilding::Create(plan, estimated).value();
  ASSERT_TRUE(building->Run({}).ok());
  given.sampling.noise_floor = {*building->noise().metrics[0], 0};
  const MapPlan less = ExamplePlan(400);
  const auto reference = MapBuilding::Create(less, given).value();
  ASSERT_TRUE(reference->Run({}).ok());
  for (const std::size_t s : {0, 1}) {
    EXPECT_EQ(building->structures()[s]->Content()->splits,
              reference->structures()[s]->Content()->splits);
    EXPECT_EQ(building->ReasonOf(s), reference->ReasonOf(s));
  }
  EXPECT_EQ(building->progress().error, reference->progress().error);
}

TEST_F(MetricNoiseTest, GivesTheSameMapWithAnyNumberOfCallsAndAfterInterruptions) {
  const MapPlan plan = ExamplePlan(101);
  const BuildOptions one = Options(1), many = Options(7);
  const auto first = MapBuilding::Create(plan, one).value();
  ASSERT_TRUE(first->Run({}).ok());
  const auto expect_same = [&](const MapBuilding& other) {
    for (const std::size_t s : {0, 1}) {
      EXPECT_EQ(first->structures()[s]->Content()->splits,
                other.structures()[s]->Content()->splits);
      EXPECT_EQ(first->structures()[s]->Content()->values,
                other.structures()[s]->Content()->values);
    }
    EXPECT_EQ(first->progress().evaluations, other.progress().evaluations);
    EXPECT_EQ(first->noise().metrics, other.noise().metrics);
  };
  const auto second = MapBuilding::Create(plan, many).value();
  ASSERT_TRUE(second->Run({}).ok());
  expect_same(*second);
  for (const std::size_t enough : {3, 11, 40}) {
    BuildOptions options = Options(3);
    KnownAnswers answers;
    kept_.reset();
    options.keep = [&](const KnownAnswers& fresh) {
      answers.insert(fresh.begin(), fresh.end());
      return absl::OkStatus();
    };
    options.cancelled = [&] { return answers.size() >= enough; };
    const auto interrupted = MapBuilding::Create(plan, options).value();
    ASSERT_TRUE(interrupted->Run({}).ok());
    options.cancelled = nullptr;
    options.noise->known = kept_;
    on_other_meshes_ = 0;
    const auto resumed = MapBuilding::Create(plan, options).value();
    ASSERT_TRUE(resumed->Run(KnownAnswers(answers)).ok());
    EXPECT_EQ(on_other_meshes_, options.noise->known ? 0 : 1) << enough;
    expect_same(*resumed);
  }
}

TEST_F(MetricNoiseTest, IsNoneWhereTheDesignFailsOnEitherMesh) {
  const MapPlan plan = ExamplePlan(101);
  BuildOptions options = Options(2);
  options.noise->evaluate = [](const Eigen::VectorXd&) {
    return DesignAnswer{PreconditionFailed("RIGID_MOTION", "it can turn"), {}};
  };
  const auto other = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(other->Run({}).ok());
  EXPECT_EQ(other->noise().metrics, std::vector<std::optional<double>>(2));
  EXPECT_EQ(other->noise().evaluations, 1);
  options = Options(2);
  options.evaluate = [evaluate = options.evaluate](const std::vector<Eigen::VectorXd>& designs) {
    auto answers = evaluate(designs);
    for (std::size_t i = 0; i < designs.size(); ++i) {
      if (designs[i] == Eigen::Vector4d(0.5, 7, 1, 11)) {
        (*answers)[i].status = PreconditionFailed("RIGID_MOTION", "it can turn");
      }
    }
    return answers;
  };
  const auto one = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(one->Run({}).ok());
  EXPECT_EQ(on_other_meshes_, 0);
  EXPECT_EQ(one->noise().evaluations, 0);
  EXPECT_TRUE(one->structures()[0]->Content().ok());
}

TEST_F(MetricNoiseTest, LosesTheEvaluatorAsTheMapDoes) {
  const MapPlan plan = ExamplePlan(101);
  BuildOptions options = Options(2);
  options.noise->evaluate = [](const Eigen::VectorXd&) -> absl::StatusOr<DesignAnswer> {
    return absl::UnavailableError("away");
  };
  EXPECT_TRUE(absl::IsUnavailable(MapBuilding::Create(plan, options).value()->Run({})));
}

// Blocks of other cells, whose stress is a little higher and whose height a little larger.
TEST(ShapeNoiseTest, ComparesShapesAndFieldsInOneMesh) {
  FileShelf shelf;
  const MapPlan plan = BlockPlan(60, 1);
  BuildOptions options = BlockOptions(plan, shelf, 2, 2, 2);
  MeshNoiseOptions noise;
  noise.of_metrics = {false};
  noise.of_shape = true;
  noise.of_fields = {"stress", "temperature"};
  noise.evaluate = [&shelf](const Eigen::VectorXd& design) {
    FormulaBlock block = PlainBlock(design);
    block.cells = 4;
    block.size.z() *= 1.04;
    block.stress = [](const Eigen::Vector3d&) { return 2.5e6; };
    block.temperature = [](const Eigen::Vector3d&) { return 500; };
    return DesignAnswer{absl::OkStatus(), Eigen::VectorXd::Constant(1, 7),
                        shelf.Put(fields::WriteFields(MakeBlock(block)).value()).value()};
  };
  noise.get = [&shelf](const std::string& file) { return shelf.Get(file); };
  options.noise = noise;
  const auto building = Built(plan, options);
  EXPECT_FALSE(building->noise().metrics.at(0).has_value());
  ASSERT_TRUE(building->noise().shape.has_value());
  EXPECT_NEAR(*building->noise().shape, 0.01, 1e-4);
  ASSERT_EQ(building->noise().fields.size(), 2u);
  for (const MeshNoise::OfField& field : building->noise().fields) {
    // Of the design in the middle: 1e6 sin(1.5 + y), y of centres of elements in [0, 1], and 300 to
    // some 305.
    const bool is_stress = field.name == "stress";
    EXPECT_GT(field.floor, is_stress ? 1.5e6 : 190);
    EXPECT_LT(field.floor, is_stress ? 2.0e6 : 200);
  }
  // What scatters so much is exact enough everywhere.
  EXPECT_EQ(building->progress().error, 0);
  const BuildOptions exact = BlockOptions(plan, shelf, 2, 2, 2);
  EXPECT_GT(Built(plan, exact)->progress().error, 0);
}

}  // namespace
}  // namespace mortise::interpolator
