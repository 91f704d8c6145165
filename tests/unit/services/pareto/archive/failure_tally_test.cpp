// Why designs failed: what counts as alike, and what is told of it.
#include "services/pareto/archive/failure_tally.h"

#include <gtest/gtest.h>

#include "services/pareto/discovery/discovery.h"

namespace mortise::pareto {
namespace {

Evaluation Failed(const std::string& reason, const std::string& message, double x = 0) {
  Evaluation failed;
  failed.x = Eigen::VectorXd::Constant(1, x);
  failed.reason = reason;
  failed.message = message;
  failed.code = absl::StatusCode::kFailedPrecondition;
  return failed;
}

TEST(FailureTallyTest, CountsWhatDiffersInNumbersOnlyAsAlike) {
  FailureTally tally;
  tally.Add(Failed("TOO_THIN", "the wall is 0.0012 m", 1));
  tally.Add(Failed("TOO_THIN", "the wall is -3.5e-05 m", 2));
  tally.Add(Failed("TOO_THIN", "the wall is 7 m", 3));
  tally.Add(Failed("TOO_THIN", "the floor is 7 m", 4));
  tally.Add(Failed("OPEN", "the wall is 7 m", 5));
  ASSERT_EQ(tally.failures().size(), 3u);
  EXPECT_EQ(tally.failures()[0].count, 3);
  EXPECT_EQ(tally.failures()[0].message, "the wall is 0.0012 m");
  EXPECT_EQ(tally.failures()[0].x[0], 1);
  EXPECT_FALSE(tally.failures()[0].same_message);
  EXPECT_TRUE(tally.failures()[1].same_message);
  EXPECT_EQ(CountsByReason(tally.failures()), "4 TOO_THIN, 1 OPEN");
  EXPECT_EQ(CountsWithExamples(tally.failures()),
            "3 TOO_THIN, such as: the wall is 0.0012 m; 1 TOO_THIN, such as: the floor is 7 m; "
            "1 OPEN, such as: the wall is 7 m");
}

TEST(FailureTallyTest, NamesTheCodeWhereThereIsNoReason) {
  FailureTally tally;
  tally.Add(Failed("", "cannot be built"));
  EXPECT_EQ(CountsByReason(tally.failures()), "1 FAILED_PRECONDITION");
}

TEST(FailureTallyTest, StaysSmallAndCountsEverything) {
  FailureTally tally;
  for (int i = 0; i < 1000; ++i) tally.Add(Failed("R", std::string(1 + i % 50, 'x')));
  EXPECT_EQ(tally.failures().size(), 16u);
  EXPECT_EQ(tally.failures().back().reason, "OTHER");
  std::int64_t count = 0;
  for (const FailureCount& failure : tally.failures()) count += failure.count;
  EXPECT_EQ(count, 1000);
}

TEST(FailureTallyTest, DiscoveriesKeepWhyDesignsFailed) {
  Discovery::Options options;
  options.evaluations = 40;
  auto discovery = *Discovery::Create({Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1)}, 2, options);
  while (const auto proposal = discovery->Ask()) {
    Evaluation evaluation = Failed("TOO_WIDE", "too wide");
    evaluation.x = proposal->x;
    if (proposal->x[0] < 0.7) {
      evaluation.status = EvaluationStatus::kEvaluated;
      evaluation.metrics = Eigen::Vector2d(proposal->x[0], 1 - proposal->x[0]);
      if (proposal->x[1] > 0.8) evaluation.metrics[0] = INFINITY;
    }
    ASSERT_TRUE(discovery->Tell(proposal->number, evaluation).ok());
  }
  const Discovery::Summary summary = discovery->summary();
  ASSERT_EQ(summary.failures.size(), 2u);
  EXPECT_EQ(summary.failures[0].count + summary.failures[1].count, summary.failed);
  const bool first = summary.failures[0].reason == "TOO_WIDE";
  EXPECT_EQ(summary.failures[first ? 1 : 0].reason, "NOT_FINITE");
}

}  // namespace
}  // namespace mortise::pareto
