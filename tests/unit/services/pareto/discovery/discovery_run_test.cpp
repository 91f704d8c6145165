// Workers, batches, cancelling and resuming: none may change the front.
#include "services/pareto/discovery/discovery_run.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>

#include "common/base/errors.h"
#include "services/pareto/discovery/robust_evaluator.h"
#include "tests/bench/pareto/benchmark_problems.h"

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

TEST_F(RunTest, GivesTheSameFrontWhateverOrderAnswersComeIn) {
  const Front reference = Reference();
  for (const std::size_t workers : {2, 5, 8}) {
    auto discovery = Make();
    std::vector<Discovery::Proposal> under_way;
    while (!discovery->Finished()) {
      while (under_way.size() < workers) {
        const auto proposal = discovery->Ask();
        if (!proposal) break;
        under_way.push_back(*proposal);
      }
      if (under_way.empty()) continue;  // that was the end
      // The latest is always the first to be answered.
      const Discovery::Proposal latest = under_way.back();
      under_way.pop_back();
      ASSERT_TRUE(discovery->Tell(latest.number, problem_.evaluate(latest.x, false)).ok());
    }
    ExpectSame(reference, discovery->front());
  }
}

// A call that never ends until it is interrupted.
class StuckEvaluator : public ProblemEvaluator {
 public:
  using ProblemEvaluator::ProblemEvaluator;

  absl::StatusOr<std::vector<Evaluation>> Evaluate(
      const std::vector<Eigen::VectorXd>& designs) override {
    if (calls() < 50) return ProblemEvaluator::Evaluate(designs);
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return interrupted_; });
    return absl::CancelledError("interrupted");
  }

  void Interrupt() override {
    const std::lock_guard lock(mutex_);
    interrupted_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool interrupted_ = false;
};

TEST_F(RunTest, SaysThatItWaitsAndKeepsWhatWasFoundWhenCancelled) {
  auto discovery = Make();
  StuckEvaluator evaluator(problem_);
  int told = 0, calls = 0;
  RunOptions options;
  options.lanes = 4;
  options.quiet = std::chrono::milliseconds(1);
  options.waiting = [&](std::chrono::seconds, int under_way) {
    ++told;
    calls = under_way;
  };
  options.cancelled = [&] { return told > 0; };
  ASSERT_TRUE(pareto::Run(*discovery, evaluator, options).ok());
  EXPECT_EQ(told, 1);
  EXPECT_GE(calls, 1);
  EXPECT_EQ(discovery->summary().stop_reason, Discovery::StopReason::kCancelled);
  EXPECT_FALSE(discovery->front().points.empty());
}

TEST_F(RunTest, SaysThatAnEvaluatorAnsweredTheWrongCount) {
  class Short : public ProblemEvaluator {
   public:
    using ProblemEvaluator::ProblemEvaluator;
    absl::StatusOr<std::vector<Evaluation>> Evaluate(
        const std::vector<Eigen::VectorXd>& designs) override {
      auto results = ProblemEvaluator::Evaluate(designs);
      if (calls() > 60) results->pop_back();
      return results;
    }
  } evaluator(problem_);
  auto discovery = Make();
  const absl::Status status = pareto::Run(*discovery, evaluator, {});
  EXPECT_EQ(status.message(), "the evaluator answered 0 of 1 designs");
  EXPECT_EQ(discovery->summary().stop_reason, Discovery::StopReason::kEvaluatorLost);
  EXPECT_FALSE(discovery->front().points.empty());
}

TEST_F(RunTest, SaysThatAnEvaluatorGaveTheWrongNumberOfMetrics) {
  class Odd : public ProblemEvaluator {
   public:
    using ProblemEvaluator::ProblemEvaluator;
    absl::StatusOr<std::vector<Evaluation>> Evaluate(
        const std::vector<Eigen::VectorXd>& designs) override {
      auto results = ProblemEvaluator::Evaluate(designs);
      if (calls() > 60) results->front().metrics.conservativeResize(1);
      return results;
    }
  } evaluator(problem_);
  auto discovery = Make();
  const absl::Status status = pareto::Run(*discovery, evaluator, {});
  EXPECT_EQ(DetailOf(status).field, "metrics");
  EXPECT_EQ(status.message(), "metrics: 2 are needed, not 1");
  EXPECT_FALSE(discovery->front().points.empty());
}

TEST_F(RunTest, ResumesWithTolerancesToTheSameFront) {
  Robustness robustness{{{1, "y", 0.2, Tolerance::Distribution::kNormal}}, 1, problem_.space};
  ProblemEvaluator inner(problem_);
  RobustEvaluator evaluator(inner, robustness);
  std::string saved;
  RunOptions options;
  options.checkpoint = [&](const Numbered& batch) {
    DiscoveryCheckpoint part;
    part.results.insert(batch.begin(), batch.end());
    if (part.results.begin()->first < 90) saved += Serialize(part);
    return absl::OkStatus();
  };
  auto first = Make();
  ASSERT_TRUE(pareto::Run(*first, evaluator, options).ok());
  auto second = Make();
  ASSERT_TRUE(pareto::Run(*second, evaluator, {}, ParseCheckpoint(saved)->results).ok());
  ExpectSame(first->front(), second->front());
  for (std::size_t i = 0; i < first->front().points.size(); ++i) {
    EXPECT_EQ(first->front().points[i].deviations, second->front().points[i].deviations);
  }
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
  evaluation.deviations = Eigen::Vector3d(0.1, 0, 7);
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
  EXPECT_EQ(parsed->results.at(4).deviations, checkpoint.results.at(4).deviations);
  EXPECT_EQ(parsed->results.at(9).message, "no such solid");
  EXPECT_EQ(parsed->results.at(9).status, EvaluationStatus::kFailed);
  EXPECT_EQ(parsed->results.at(9).reason, "FEATURE_FAILED");
  EXPECT_EQ(parsed->results.at(9).code, absl::StatusCode::kFailedPrecondition);
}

constexpr std::size_t kEmptyDeviations = sizeof(std::uint64_t);
constexpr std::size_t kEmptyConstraints = 2 * sizeof(std::uint64_t) + kEmptyDeviations;
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

TEST(CheckpointTest, ReadsWhatWasWrittenBeforeThereWereTolerances) {
  Evaluation failed;
  failed.x = Eigen::VectorXd::Constant(1, 2.5);
  failed.reason = "RIGID_MOTION";
  DiscoveryCheckpoint checkpoint;
  checkpoint.results[3] = failed;
  std::string old = Serialize(checkpoint);
  old.replace(0, 4, "MPC3");
  old.resize(old.size() - kEmptyDeviations);
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
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    EXPECT_FALSE(ParseCheckpoint(bytes.substr(0, size)).ok()) << size;
  }
  EXPECT_FALSE(ParseCheckpoint("nonsense").ok());
  EXPECT_TRUE(ParseCheckpoint("").ok());
}

}  // namespace
}  // namespace mortise::pareto
