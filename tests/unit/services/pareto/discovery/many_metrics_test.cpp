// Discovery of fronts of four to six metrics.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "services/pareto/front/front_labeling.h"
#include "tests/bench/pareto/benchmark_run.h"

namespace mortise::pareto {
namespace {

// Whether a point is the best or the worst of a metric.
bool IsEnd(const Front& front, const FrontPoint& point) {
  for (Eigen::Index k = 0; k < point.metrics.size(); ++k) {
    const auto [least, most] = std::ranges::minmax_element(
        front.points, {}, [k](const FrontPoint& other) { return other.metrics[k]; });
    if (point.metrics[k] == least->metrics[k] || point.metrics[k] == most->metrics[k]) return true;
  }
  return false;
}

class ManyMetrics : public testing::TestWithParam<int> {
 protected:
  // With gradients, so that pieces are found within few evaluations.
  BenchmarkResult Run(std::int64_t evaluations) {
    const int d = GetParam();
    problem_ = *MakeBenchmarkProblem("DTLZ2", PublishedDimensions("DTLZ2", d), {.metrics = d});
    Discovery::Options options;
    options.evaluations = evaluations;
    options.surrogate = Discovery::Surrogate::kNever;
    options.stall_tracks = 0;
    return *RunBenchmark(problem_, options, true);
  }

  BenchmarkProblem problem_;
};
INSTANTIATE_TEST_SUITE_P(Metrics, ManyMetrics, testing::Values(4, 5, 6));

TEST_P(ManyMetrics, FrontsAreFoundWithinTheBudget) {
  const BenchmarkResult result = Run(400);
  EXPECT_EQ(result.evaluations, 400);
  EXPECT_GT(result.hypervolume, 0.65 * problem_.hypervolume);
  EXPECT_LE(result.hypervolume, 1.001 * problem_.hypervolume);
}

TEST_P(ManyMetrics, FrontsArePointsThatNothingDominatesByMuch) {
  const int d = GetParam();
  const BenchmarkResult result = Run(400);
  const Front& front = result.front;
  ASSERT_GT(front.points.size(), 20u);
  std::map<std::int64_t, std::vector<double>>
      cells;  // distances from the ideal of all but the ends
  for (const FrontPoint& point : front.points) {
    EXPECT_EQ(point.embedding.size(), d - 1);
    EXPECT_GE(point.embedding.minCoeff(), 0);
    EXPECT_LE(point.embedding.maxCoeff(), 1);
    EXPECT_GE(point.cell, 0);
    if (!IsEnd(front, point)) {
      cells[point.cell].push_back(front.scaling.Apply(point.metrics).norm() -
                                  point.approximation_error);
    }
    EXPECT_LE(point.approximation_error, 0.01 + 1e-9);
  }
  // One a cell, and further ones only where the front goes on along its rays.
  for (auto& [cell, distances] : cells) {
    std::ranges::sort(distances);
    for (std::size_t i = 1; i < distances.size(); ++i) {
      EXPECT_GT(distances[i], distances[i - 1] + 0.01);
    }
  }
  // A quarter of the budget after Rebuild.
  EXPECT_LE(result.summary.cells_covered, 100);
}

// Near the axis of the first metric the other angles say nothing.
TEST(NeighboursOnManyMetrics, AreTheNearestRays) {
  Eigen::MatrixXd embedding = Eigen::MatrixXd::Constant(3, 40, 0.5);
  for (Eigen::Index i = 0; i < embedding.cols(); ++i) {
    embedding(0, i) = 0.4 + 0.01 * static_cast<double>(i);
  }
  embedding.col(7) << 0.01, 0.05, 0.9;
  embedding.col(31) << 0.01, 0.95, 0.1;
  const auto pairs = NeighboursAlong(embedding);
  EXPECT_NE(std::ranges::find(pairs, std::pair(7, 31)), pairs.end());
}

}  // namespace
}  // namespace mortise::pareto
