#include "services/pareto/benchmark_run.h"

#include <gtest/gtest.h>

#include "services/pareto/non_dominated.h"

namespace mortise::pareto {
namespace {

TEST(BenchmarkRun, GivesEveryDesignThatNoneDominates) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT3", 5, {true, true, 2});
  Discovery::Options options;
  options.evaluations = 400;
  options.stall_tracks = 0;
  int reports = 0;
  const auto result =
      RunBenchmark(problem, options, false, [&](const Discovery::Summary&) { ++reports; });
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->evaluations, 400);
  EXPECT_EQ(result->summary.evaluations, 400);
  EXPECT_EQ(reports, 100);
  EXPECT_GT(result->own_seconds, 0);
  EXPECT_GT(result->hypervolume, 0);
  EXPECT_LT(result->hypervolume, problem.hypervolume);
  ASSERT_GT(result->non_dominated.size(), 5u);
  for (const BenchmarkPoint& point : result->non_dominated) {
    EXPECT_EQ(problem.evaluate(point.x, false).metrics, point.metrics);
    for (const BenchmarkPoint& other : result->non_dominated)
      EXPECT_FALSE(Dominates(other.metrics, point.metrics));
  }
}

TEST(BenchmarkRun, IsTheSameForTheSameSeed) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("DTLZ2", 5);
  Discovery::Options options;
  options.evaluations = 200;
  const auto first = RunBenchmark(problem, options, true);
  const auto second = RunBenchmark(problem, options, true);
  ASSERT_TRUE(first.ok() && second.ok());
  ASSERT_EQ(first->non_dominated.size(), second->non_dominated.size());
  for (std::size_t i = 0; i < first->non_dominated.size(); ++i)
    EXPECT_EQ(first->non_dominated[i].x, second->non_dominated[i].x);
}

TEST(BenchmarkRun, KeepsWhatItHasWhenCancelled) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT1", 5);
  Discovery::Options options;
  options.evaluations = 1000;
  const auto result = RunBenchmark(problem, options, false, {}, [] { return true; });
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->summary.stop_reason, Discovery::StopReason::kCancelled);
  EXPECT_EQ(result->evaluations, 10);
  EXPECT_FALSE(result->non_dominated.empty());
}

TEST(BenchmarkRun, RefusesWhatDiscoveryRefuses) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT1", 5);
  Discovery::Options options;
  options.evaluations = 0;
  EXPECT_TRUE(absl::IsInvalidArgument(RunBenchmark(problem, options, false).status()));
}

}  // namespace
}  // namespace mortise::pareto
