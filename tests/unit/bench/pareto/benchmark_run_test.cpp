#include "tests/bench/pareto/benchmark_run.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "services/pareto/archive/non_dominated.h"
#include "services/pareto/front/front_error.h"
#include "services/pareto/models/first_order_expansion.h"

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
    for (const BenchmarkPoint& other : result->non_dominated) {
      EXPECT_FALSE(Dominates(other.metrics, point.metrics));
    }
  }
}

// How far a design of the scaled problem is from the front, to second order: half of what a Newton
// step towards it would gain along the normal (Eq. 7.8).
double DistanceToFront(const BenchmarkProblem& problem, const Eigen::VectorXd& x,
                       const Eigen::VectorXd& range) {
  const auto jacobian_at = [&](const Eigen::VectorXd& at) -> Eigen::MatrixXd {
    return range.cwiseInverse().asDiagonal() * problem.evaluate(at, true).jacobian;
  };
  const Eigen::VectorXd u =
      (x - problem.space.lower).cwiseQuotient(problem.space.upper - problem.space.lower);
  const Eigen::MatrixXd jacobian = jacobian_at(x);
  const KktPoint kkt = RecoverDuals(jacobian, u);
  const Eigen::VectorXd weights = kkt.alpha.normalized();
  Eigen::MatrixXd hessian(x.size(), x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::VectorXd up = x, down = x;
    up[i] += 1e-5;
    down[i] -= 1e-5;
    hessian.col(i) = (jacobian_at(up) - jacobian_at(down)).transpose() * weights / 2e-5;
  }
  const Eigen::VectorXd slope = (jacobian.transpose() * weights)(kkt.free);
  const Eigen::MatrixXd curvature = hessian(kkt.free, kkt.free);
  return 0.5 * slope.dot(curvature.ldlt().solve(slope));
}

// The thesis's measure of its Figure 7-9: 97 % of points below 1e-5.
TEST(BenchmarkRun, PutsThePointsOfTheFourierFrontOnIt) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("Fourier", 3, {.instance = 3});
  Discovery::Options options;
  options.evaluations = 3000;
  options.seed = 3;
  options.stall_tracks = 0;
  const auto result = RunBenchmark(problem, options, false);
  ASSERT_TRUE(result.ok());
  const std::vector<FrontPoint>& points = result->front.points;
  ASSERT_GT(points.size(), 200u);
  Eigen::VectorXd least = points.front().metrics, most = least;
  for (const FrontPoint& point : points) {
    least = least.cwiseMin(point.metrics).eval();
    most = most.cwiseMax(point.metrics).eval();
  }
  std::size_t close = 0;
  for (const FrontPoint& point : points) {
    const double distance = std::abs(DistanceToFront(problem, point.x, most - least));
    EXPECT_LT(distance, 4e-4);
    close += distance < 1e-5 ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(close), 0.97 * static_cast<double>(points.size()));
}

TEST(BenchmarkRun, PutsThePointsOfAFourierFrontOfThreeMetricsOnIt) {
  const BenchmarkProblem problem =
      *MakeBenchmarkProblem("Fourier", 3, {.instance = 2, .metrics = 3});
  Discovery::Options options;
  options.evaluations = 5000;
  options.seed = 2;
  options.stall_tracks = 0;
  const auto result = RunBenchmark(problem, options, false);
  ASSERT_TRUE(result.ok());
  const std::vector<double> errors =
      FrontErrors(problem.space, result->front,
                  [&](const Eigen::VectorXd& x) { return problem.evaluate(x, true); });
  ASSERT_GT(errors.size(), 300u);
  EXPECT_LT(std::ranges::max(errors), 4e-4);
  const auto close = std::ranges::count_if(errors, [](double error) { return error < 1e-5; });
  EXPECT_GT(static_cast<double>(close), 0.97 * static_cast<double>(errors.size()));
}

TEST(BenchmarkRun, TellsOfWhatItFindsOnTheWay) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT1", 5);
  Discovery::Options options;
  options.evaluations = 400;
  Discovery::Summary last;
  const auto result = RunBenchmark(problem, options, false, [&](const Discovery::Summary& now) {
    EXPECT_GE(now.evaluations, last.evaluations);
    EXPECT_GE(now.pieces, last.pieces);
    last = now;
  });
  ASSERT_TRUE(result.ok());
  EXPECT_GE(last.pieces, 1);
  EXPECT_GT(last.cells_covered, 50);
  EXPECT_GT(last.hypervolume, 0.5);
}

TEST(BenchmarkRun, IsTheSameForTheSameSeed) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("DTLZ2", 5);
  Discovery::Options options;
  options.evaluations = 200;
  const auto first = RunBenchmark(problem, options, true);
  const auto second = RunBenchmark(problem, options, true);
  ASSERT_TRUE(first.ok() && second.ok());
  ASSERT_EQ(first->non_dominated.size(), second->non_dominated.size());
  for (std::size_t i = 0; i < first->non_dominated.size(); ++i) {
    EXPECT_EQ(first->non_dominated[i].x, second->non_dominated[i].x);
  }
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
