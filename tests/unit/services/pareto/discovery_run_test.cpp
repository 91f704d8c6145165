// Workers, batches, cancelling and resuming: none may change the front.
#include "services/pareto/discovery_run.h"

#include <gtest/gtest.h>

#include <atomic>

#include "services/pareto/benchmark_problems.h"

namespace mortise::pareto {
namespace {

using Numbered = std::vector<std::pair<std::int64_t, Evaluation>>;

class ProblemEvaluator : public Evaluator {
 public:
  explicit ProblemEvaluator(const BenchmarkProblem& problem) : problem_(problem) {}

  absl::StatusOr<std::vector<Evaluation>> Evaluate(
      const std::vector<Eigen::VectorXd>& designs) override {
    const int call = calls_++;
    if (lost_after >= 0 && call >= lost_after) return absl::UnavailableError("away");
    std::vector<Evaluation> results;
    for (const auto& x : designs) results.push_back(problem_.evaluate(x, false));
    return results;
  }

  int calls() const { return calls_; }
  int lost_after = -1;

 private:
  const BenchmarkProblem& problem_;
  std::atomic<int> calls_ = 0;
};

class RunTest : public testing::Test {
 protected:
  std::unique_ptr<Discovery> Make() {
    Discovery::Options options;
    options.evaluations = 200;
    options.seed = 5;
    options.surrogate = Discovery::Surrogate::kNever;
    return *Discovery::Create(problem_.space, 2, options);
  }

  static void ExpectSame(const Front& a, const Front& b) {
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i) {
      EXPECT_EQ(a.points[i].x, b.points[i].x);  // bit for bit
      EXPECT_EQ(a.points[i].metrics, b.points[i].metrics);
      EXPECT_EQ(a.points[i].piece, b.points[i].piece);
      EXPECT_EQ(a.points[i].cell, b.points[i].cell);
    }
  }

  Front Reference() {
    auto discovery = Make();
    ProblemEvaluator evaluator(problem_);
    EXPECT_TRUE(pareto::Run(*discovery, evaluator, {}).ok());
    return discovery->front();
  }

  BenchmarkProblem problem_ = *MakeBenchmarkProblem("Kursawe", 3);
};

TEST_F(RunTest, GivesTheSameFrontForAnyWorkersAndBatches) {
  const Front reference = Reference();
  for (const auto& [lanes, batch] :
       std::vector<std::pair<int, int>>{{1, 8}, {2, 1}, {3, 2}, {8, 1}}) {
    auto discovery = Make();
    ProblemEvaluator evaluator(problem_);
    RunOptions options;
    options.lanes = lanes;
    options.batch_size = batch;
    ASSERT_TRUE(pareto::Run(*discovery, evaluator, options).ok());
    ExpectSame(reference, discovery->front());
  }
}

TEST_F(RunTest, ResumesFromACheckpointToTheSameFront) {
  const Front reference = Reference();
  for (const int stop_after : {1, 30, 90}) {
    std::string saved;
    auto first = Make();
    ProblemEvaluator evaluator(problem_);
    evaluator.lost_after = stop_after;
    RunOptions options;
    options.lanes = 3;
    options.checkpoint = [&](const Numbered& batch) {
      DiscoveryCheckpoint part;
      part.results.insert(batch.begin(), batch.end());
      saved += Serialize(part);
      return absl::OkStatus();
    };
    EXPECT_TRUE(absl::IsUnavailable(pareto::Run(*first, evaluator, options)));
    EXPECT_EQ(first->summary().stop_reason, Discovery::StopReason::kEvaluatorLost);

    const auto checkpoint = ParseCheckpoint(saved);
    ASSERT_TRUE(checkpoint.ok());
    EXPECT_EQ(static_cast<int>(checkpoint->results.size()), stop_after);
    auto second = Make();
    ProblemEvaluator again(problem_);
    ASSERT_TRUE(pareto::Run(*second, again, {}, checkpoint->results).ok());
    EXPECT_EQ(again.calls(), 200 - stop_after);
    ExpectSame(reference, second->front());
  }
}

TEST_F(RunTest, CancelKeepsTheBestSoFar) {
  auto discovery = Make();
  ProblemEvaluator evaluator(problem_);
  RunOptions options;
  options.cancelled = [&] { return evaluator.calls() >= 60; };
  ASSERT_TRUE(pareto::Run(*discovery, evaluator, options).ok());
  const Discovery::Summary summary = discovery->summary();
  EXPECT_EQ(summary.stop_reason, Discovery::StopReason::kCancelled);
  EXPECT_GE(summary.evaluations, 59);
  EXPECT_LT(summary.evaluations, 70);
  EXPECT_FALSE(discovery->front().points.empty());
}

TEST_F(RunTest, ReportsProgress) {
  auto discovery = Make();
  ProblemEvaluator evaluator(problem_);
  std::int64_t last = 0;
  double hypervolume = 0;
  RunOptions options;
  options.progress = [&](const Discovery::Summary& summary) {
    EXPECT_GE(summary.evaluations, last);
    last = summary.evaluations;
    hypervolume = summary.hypervolume;
  };
  ASSERT_TRUE(pareto::Run(*discovery, evaluator, options).ok());
  EXPECT_GT(last, 150);
  EXPECT_GT(hypervolume, 0);
}

TEST_F(RunTest, EndsAsItsJudgeSays) {
  auto discovery = Make();
  ProblemEvaluator evaluator(problem_);
  RunOptions options;
  options.judge = [](const Discovery::Summary& summary) {
    return summary.evaluations < 20 ? absl::OkStatus() : absl::FailedPreconditionError("useless");
  };
  EXPECT_TRUE(absl::IsFailedPrecondition(pareto::Run(*discovery, evaluator, options)));
  EXPECT_LT(evaluator.calls(), 40);
}

TEST_F(RunTest, RefusesResultsOfAnotherDiscovery) {
  auto discovery = Make();
  ProblemEvaluator evaluator(problem_);
  std::map<std::int64_t, Evaluation> known;
  known[0] = problem_.evaluate(Eigen::VectorXd::Zero(3), false);
  EXPECT_EQ(pareto::Run(*discovery, evaluator, {}, known).code(), absl::StatusCode::kDataLoss);
}

TEST(CheckpointTest, RoundTripsBitForBit) {
  DiscoveryCheckpoint checkpoint;
  Evaluation evaluation;
  evaluation.x = Eigen::Vector2d(0.1, -1e-300);
  evaluation.status = EvaluationStatus::kEvaluated;
  evaluation.metrics = Eigen::Vector3d(1, 2, 3);
  evaluation.jacobian = Eigen::MatrixXd::Random(3, 2);
  evaluation.constraints = Eigen::Vector2d(-1, 1e9);
  evaluation.constraint_jacobian = Eigen::MatrixXd::Random(2, 2);
  checkpoint.results[4] = evaluation;
  evaluation = {};
  evaluation.x = Eigen::Vector2d(1, 2);
  evaluation.message = "no such solid";
  evaluation.reason = "FEATURE_FAILED";
  evaluation.code = absl::StatusCode::kFailedPrecondition;
  checkpoint.results[9] = evaluation;
  const auto parsed = ParseCheckpoint(Serialize(checkpoint));
  ASSERT_TRUE(parsed.ok());
  ASSERT_EQ(parsed->results.size(), 2u);
  EXPECT_EQ(parsed->results.at(4).jacobian, checkpoint.results.at(4).jacobian);
  EXPECT_EQ(parsed->results.at(4).constraints, checkpoint.results.at(4).constraints);
  EXPECT_EQ(parsed->results.at(4).constraint_jacobian,
            checkpoint.results.at(4).constraint_jacobian);
  EXPECT_EQ(parsed->results.at(9).message, "no such solid");
  EXPECT_EQ(parsed->results.at(9).status, EvaluationStatus::kFailed);
  EXPECT_EQ(parsed->results.at(9).reason, "FEATURE_FAILED");
  EXPECT_EQ(parsed->results.at(9).code, absl::StatusCode::kFailedPrecondition);
}

constexpr std::size_t kEmptyConstraints = 2 * sizeof(std::uint64_t);
constexpr std::size_t kEmptyReason = sizeof(std::int32_t) + sizeof(std::uint64_t);

TEST(CheckpointTest, ReadsWhatWasWrittenBeforeFailuresHadReasons) {
  Evaluation failed;
  failed.x = Eigen::VectorXd::Constant(1, 2.5);
  failed.message = "cannot be built";
  DiscoveryCheckpoint checkpoint;
  checkpoint.results[3] = failed;
  std::string old = Serialize(checkpoint);
  old.replace(0, 4, "MPC1");
  old.resize(old.size() - kEmptyReason - kEmptyConstraints);
  const auto parsed = ParseCheckpoint(old + Serialize(checkpoint));
  ASSERT_TRUE(parsed.ok()) << parsed.status();
  EXPECT_EQ(parsed->results.at(3).message, "cannot be built");
  EXPECT_TRUE(ParseCheckpoint(old).ok());
}

TEST(CheckpointTest, ReadsWhatWasWrittenBeforeThereWereConstraints) {
  Evaluation failed;
  failed.x = Eigen::VectorXd::Constant(1, 2.5);
  failed.reason = "RIGID_MOTION";
  DiscoveryCheckpoint checkpoint;
  checkpoint.results[3] = failed;
  std::string old = Serialize(checkpoint);
  old.replace(0, 4, "MPC2");
  old.resize(old.size() - kEmptyConstraints);
  const auto parsed = ParseCheckpoint(old);
  ASSERT_TRUE(parsed.ok()) << parsed.status();
  EXPECT_EQ(parsed->results.at(3).reason, "RIGID_MOTION");
}

TEST(CheckpointTest, RefusesDamage) {
  DiscoveryCheckpoint checkpoint;
  Evaluation evaluation;
  evaluation.x = Eigen::Vector2d(0.1, 2);
  checkpoint.results[0] = evaluation;
  const std::string bytes = Serialize(checkpoint);
  for (std::size_t size = 1; size < bytes.size(); ++size)
    EXPECT_FALSE(ParseCheckpoint(bytes.substr(0, size)).ok()) << size;
  EXPECT_FALSE(ParseCheckpoint("nonsense").ok());
  EXPECT_TRUE(ParseCheckpoint("").ok());
}

}  // namespace
}  // namespace mortise::pareto
