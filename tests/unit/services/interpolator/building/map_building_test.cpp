// Building maps of a function, with any number of calls at once, and what interrupts it.
#include "services/interpolator/building/map_building.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "common/base/errors.h"
#include "tests/unit/services/interpolator/building/example_plan.h"

namespace mortise::interpolator {
namespace {

DesignAnswer AnswerOf(const Eigen::VectorXd& design) {
  return {absl::OkStatus(), Eigen::Vector2d(std::sin(3 * design[0]) + design[2] + design[3],
                                            std::exp(design[0]) * design[2] * design[3])};
}

BuildOptions OptionsOf(int lanes, int batch_size) {
  BuildOptions options;
  options.lanes = lanes;
  options.batch_size = batch_size;
  options.evaluate = [](const std::vector<Eigen::VectorXd>& designs) {
    std::vector<DesignAnswer> answers;
    for (const Eigen::VectorXd& design : designs) answers.push_back(AnswerOf(design));
    return answers;
  };
  return options;
}

void ExpectSame(const MapBuilding& a, const MapBuilding& b) {
  for (std::size_t s = 0; s < a.structures().size(); ++s) {
    const maps::MapContent first = a.structures()[s]->Content().value();
    const maps::MapContent second = b.structures()[s]->Content().value();
    EXPECT_EQ(first.splits, second.splits);
    EXPECT_EQ(first.values, second.values);
    EXPECT_EQ(first.errors, second.errors);
  }
}

TEST(MapBuildingTest, MakesTheSameMapWithAnyNumberOfCalls) {
  const MapPlan plan = ExamplePlan(101);
  const BuildOptions one = OptionsOf(1, 1), many = OptionsOf(7, 5);
  const auto first = MapBuilding::Create(plan, one).value();
  const auto second = MapBuilding::Create(plan, many).value();
  ASSERT_TRUE(first->Run({}).ok());
  ASSERT_TRUE(second->Run({}).ok());
  ASSERT_EQ(first->structures().size(), 2u);
  EXPECT_LE(first->progress().evaluations, 101);
  EXPECT_GT(first->progress().evaluations, 60);
  EXPECT_EQ(first->ReasonOf(0), StopReason::kBudget);
  ExpectSame(*first, *second);
}

TEST(MapBuildingTest, GoesOnFromKeptAnswersToTheSameMap) {
  const MapPlan plan = ExamplePlan(100);
  BuildOptions options = OptionsOf(3, 4);
  KnownAnswers kept;
  std::atomic<bool> is_cancelled = false;
  options.keep = [&](const KnownAnswers& answers) {
    kept.insert(answers.begin(), answers.end());
    if (kept.size() > 40) is_cancelled = true;
    return absl::OkStatus();
  };
  options.cancelled = [&] { return is_cancelled.load(); };
  const auto interrupted = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(interrupted->Run({}).ok());
  EXPECT_EQ(interrupted->ReasonOf(0), StopReason::kCancelled);
  const std::size_t known = kept.size();
  ASSERT_LT(known, 80u);

  options.cancelled = nullptr;
  const auto resumed = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(resumed->Run(KnownAnswers(kept)).ok());
  const BuildOptions plain = OptionsOf(1, 1);
  const auto reference = MapBuilding::Create(plan, plain).value();
  ASSERT_TRUE(reference->Run({}).ok());
  ExpectSame(*resumed, *reference);
  // Each answer was kept once, and what was known was not asked.
  EXPECT_EQ(static_cast<std::int64_t>(kept.size()), reference->progress().evaluations);
}

TEST(MapBuildingTest, CountsWhatIsNotFiniteAsFailed) {
  const MapPlan plan = ExamplePlan(60);
  BuildOptions options = OptionsOf(2, 3);
  options.evaluate = [](const std::vector<Eigen::VectorXd>& designs) {
    std::vector<DesignAnswer> answers;
    for (const Eigen::VectorXd& design : designs) {
      answers.push_back(AnswerOf(design));
      if (design[0] > 0.9) answers.back().values[1] = std::numeric_limits<double>::quiet_NaN();
    }
    return answers;
  };
  const auto building = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(building->Run({}).ok());
  const BuildProgress progress = building->progress();
  ASSERT_EQ(progress.failures.size(), 1u);
  EXPECT_EQ(progress.failures[0].reason, "NOT_FINITE");
  EXPECT_NE(progress.failures[0].message.find("'product'"), std::string::npos);
  EXPECT_EQ(progress.failures[0].count, progress.failed);
  EXPECT_EQ(progress.failures[0].x.size(), 3);
  EXPECT_LT(progress.failed, progress.evaluations);
}

TEST(MapBuildingTest, EndsWithWhatTheEvaluatorOrTheJudgeSays) {
  const MapPlan plan = ExamplePlan(60);
  BuildOptions options = OptionsOf(4, 2);
  options.judge = [](const BuildProgress&) { return PreconditionFailed("USELESS", "it is"); };
  EXPECT_TRUE(absl::IsFailedPrecondition(MapBuilding::Create(plan, options).value()->Run({})));
  options = OptionsOf(4, 2);
  options.evaluate = [](const auto&) { return absl::UnavailableError("away"); };
  EXPECT_TRUE(absl::IsUnavailable(MapBuilding::Create(plan, options).value()->Run({})));
}

TEST(MapBuildingTest, StopsWhenItsTimeIsOver) {
  const MapPlan plan = ExamplePlan(1000);
  BuildOptions options = OptionsOf(2, 2);
  std::atomic<int> batches = 0;
  options.judge = [&](const BuildProgress&) {
    ++batches;
    return absl::OkStatus();
  };
  options.is_out_of_time = [&] { return batches > 15; };
  const auto building = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(building->Run({}).ok());
  EXPECT_EQ(building->ReasonOf(1), StopReason::kTime);
  EXPECT_LT(building->progress().evaluations, 100);
  EXPECT_TRUE(building->structures()[1]->Content().ok());
}

TEST(MapBuildingTest, HasAMapWhereItsTimeIsOverBeforeItBegins) {
  const MapPlan plan = ExamplePlan(1000);
  BuildOptions options = OptionsOf(2, 2);
  options.is_out_of_time = [] { return true; };
  const auto building = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(building->Run({}).ok());
  EXPECT_EQ(building->ReasonOf(0), StopReason::kTime);
  EXPECT_LT(building->progress().evaluations, 100);
  for (const auto& structure : building->structures()) EXPECT_TRUE(structure->Content().ok());
}

TEST(MapBuildingTest, HasWhatWasKeptWhereItIsCancelledBeforeItGoesOn) {
  const MapPlan plan = ExamplePlan(100);
  BuildOptions options = OptionsOf(3, 4);
  KnownAnswers kept;
  options.keep = [&kept](const KnownAnswers& answers) {
    kept.insert(answers.begin(), answers.end());
    return absl::OkStatus();
  };
  options.cancelled = [&kept] { return kept.size() > 60; };
  const auto interrupted = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(interrupted->Run({}).ok());
  std::atomic<int> asked = 0;
  options.evaluate = [&asked](const auto&) {
    ++asked;
    return absl::UnavailableError("away");
  };
  options.cancelled = [] { return true; };
  const auto resumed = MapBuilding::Create(plan, options).value();
  ASSERT_TRUE(resumed->Run(KnownAnswers(kept)).ok());
  EXPECT_EQ(asked, 0);
  EXPECT_EQ(resumed->progress().evaluations, static_cast<std::int64_t>(kept.size()));
  ExpectSame(*resumed, *interrupted);
}

}  // namespace
}  // namespace mortise::interpolator
