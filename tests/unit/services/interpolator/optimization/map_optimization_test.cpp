// The best point of a map: against minima known in closed form, over smooth functions and over
// those with kinks, and the promises of the search.
#include "services/interpolator/optimization/map_optimization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace mortise::interpolator {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

parametric::Expression Parsed(const std::string& text) {
  return *parametric::Expression::Parse(text, {"x", "y", "f", "g"});
}

// f = (x - 2)^2 + 3 (y + 1)^2 and g = x + y, over x in [-4, 4] and y in [-4, 4].
MapOptimization Bowl() {
  return {.lower = VectorXd::Constant(2, -4.0),
          .upper = VectorXd::Constant(2, 4.0),
          .ranges = Eigen::Vector2d(111, 16),
          .objective = Parsed("f"),
          .limits = {}};
}

absl::StatusOr<PointMetrics> BowlValues(const VectorXd& at, bool /*gradients*/) {
  PointMetrics values{.metrics = VectorXd(2), .gradients = MatrixXd(2, 2)};
  values.metrics << std::pow(at(0) - 2, 2) + 3 * std::pow(at(1) + 1, 2), at(0) + at(1);
  values.gradients << 2 * (at(0) - 2), 6 * (at(1) + 1), 1, 1;
  return values;
}

// f = |x - 1| + |x + y|, g = x: minimal at (1, -1), on two kinks.
absl::StatusOr<PointMetrics> KinkValues(const VectorXd& at, bool /*gradients*/) {
  PointMetrics values{.metrics = VectorXd(2), .gradients = MatrixXd(2, 2)};
  const double a = at(0) - 1, b = at(0) + at(1);
  values.metrics << std::abs(a) + std::abs(b), at(0);
  values.gradients << std::copysign(1.0, a) + std::copysign(1.0, b), std::copysign(1.0, b), 1, 0;
  return values;
}

TEST(MapOptimizationTest, FindsTheBottomOfABowl) {
  const auto optimum = Optimize(Bowl(), BowlValues);
  ASSERT_TRUE(optimum.ok()) << optimum.status();
  EXPECT_LT((optimum->parameters - Eigen::Vector2d(2, -1)).norm(), 1e-4);
  EXPECT_NEAR(optimum->objective, 0, 1e-8);
  EXPECT_EQ(optimum->violation, 0);
  EXPECT_EQ(optimum->starts_that_agree, 16);
}

TEST(MapOptimizationTest, KeepsLimitsFromBothSides) {
  // On the line x + y = 3 Lagrange gives x - 2 = 3 (y + 1), so (3.5, -0.5); on x + y = -1, (0.5,
  // -1.5).
  for (const double bound : {3.0, -1.0}) {
    MapOptimization problem = Bowl();
    MetricLimit limit;
    limit.metric = 1;
    (bound > 0 ? limit.minimum : limit.maximum) = bound;
    problem.limits = {limit};
    const auto optimum = Optimize(problem, BowlValues);
    ASSERT_TRUE(optimum.ok()) << optimum.status();
    const Eigen::Vector2d expected =
        bound > 0 ? Eigen::Vector2d(3.5, -0.5) : Eigen::Vector2d(0.5, -1.5);
    EXPECT_LT((optimum->parameters - expected).norm(), 1e-3);
    EXPECT_EQ(optimum->violation, 0);
    EXPECT_NEAR(optimum->metrics(1), bound, 1e-4);
  }
}

TEST(MapOptimizationTest, MaximisesAnExpressionOfParametersAndMetrics) {
  MapOptimization problem = Bowl();
  problem.objective = Parsed("x * y - f");  // stationary where y = 2 x - 4 and x = 6 y + 6
  problem.maximize = true;
  const auto optimum = Optimize(problem, BowlValues);
  ASSERT_TRUE(optimum.ok()) << optimum.status();
  EXPECT_LT((optimum->parameters - Eigen::Vector2d(18.0 / 11, -8.0 / 11)).norm(), 1e-3);
}

TEST(MapOptimizationTest, LeavesFixedParametersAlone) {
  MapOptimization problem = Bowl();
  problem.lower(0) = problem.upper(0) = 1;
  const auto optimum = Optimize(problem, BowlValues);
  ASSERT_TRUE(optimum.ok()) << optimum.status();
  EXPECT_EQ(optimum->parameters(0), 1);
  EXPECT_NEAR(optimum->parameters(1), -1, 1e-4);
  problem.lower(1) = problem.upper(1) = 2;
  const auto only = Optimize(problem, BowlValues);
  ASSERT_TRUE(only.ok()) << only.status();
  EXPECT_EQ(only->parameters, (Eigen::Vector2d(1, 2)));
}

TEST(MapOptimizationTest, GetsPastKinks) {
  const auto optimum = Optimize(Bowl(), KinkValues);
  ASSERT_TRUE(optimum.ok()) << optimum.status();
  EXPECT_LT((optimum->parameters - Eigen::Vector2d(1, -1)).norm(), 2e-3);
}

TEST(MapOptimizationTest, SaysByHowMuchLimitsAreMissedThatNothingKeeps) {
  MapOptimization problem = Bowl();
  problem.limits = {{.metric = 1, .minimum = 10.0, .maximum = {}}};
  const auto optimum = Optimize(problem, BowlValues);
  ASSERT_TRUE(optimum.ok()) << optimum.status();
  EXPECT_GT(optimum->violation, 0.05);
  EXPECT_LT((optimum->parameters - Eigen::Vector2d(4, 4)).norm(), 1e-2);
  EXPECT_NEAR(optimum->violation, 2.0 / 16, 1e-3);
}

TEST(MapOptimizationTest, KeepsSmallLimitsFromOneStart) {
  // In other units, where all is a millionth: nothing is judged by what a number is in itself.
  const MapFunction small = [](const VectorXd& at, bool gradients) -> absl::StatusOr<PointMetrics> {
    auto values = BowlValues(at, gradients);
    values->metrics *= 1e-6;
    values->gradients *= 1e-6;
    return values;
  };
  MapOptimization problem = Bowl();
  problem.ranges *= 1e-6;
  problem.starts = 1;
  MetricLimit limit;
  limit.metric = 1;
  limit.minimum = 3e-6;
  problem.limits = {limit};
  const auto optimum = Optimize(problem, small);
  ASSERT_TRUE(optimum.ok()) << optimum.status();
  EXPECT_LT((optimum->parameters - Eigen::Vector2d(3.5, -0.5)).norm(), 1e-2);
  EXPECT_EQ(optimum->violation, 0);
  EXPECT_GE(optimum->metrics(1), 3e-6 * (1 - 1e-5));
}

TEST(MapOptimizationTest, EndsWhereItIsGivenUp) {
  int asked = 0;
  const MapFunction given_up = [&asked](const VectorXd& at,
                                        bool gradients) -> absl::StatusOr<PointMetrics> {
    if (++asked > 50) return absl::CancelledError("given up");
    return BowlValues(at, gradients);
  };
  EXPECT_EQ(Optimize(Bowl(), given_up).status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(asked, 51);
}

TEST(MapOptimizationTest, StaysWhereTheMapHasSomething) {
  const MapFunction half = [](const VectorXd& at, bool gradients) -> absl::StatusOr<PointMetrics> {
    if (at(0) > 1) return absl::OutOfRangeError("cut off");
    return BowlValues(at, gradients);
  };
  const auto optimum = Optimize(Bowl(), half);
  ASSERT_TRUE(optimum.ok()) << optimum.status();
  EXPECT_LE(optimum->parameters(0), 1);
  const MapFunction none = [](const VectorXd&, bool) -> absl::StatusOr<PointMetrics> {
    return absl::OutOfRangeError("cut off");
  };
  EXPECT_EQ(Optimize(Bowl(), none).status().code(), absl::StatusCode::kOutOfRange);
}

TEST(MapOptimizationTest, GivesTheSameForASeed) {
  MapOptimization problem = Bowl();
  problem.objective = Parsed("sin(3 * x) * cos(2 * y) + f / 50");
  problem.seed = 7;
  const auto once = Optimize(problem, BowlValues);
  const auto again = Optimize(problem, BowlValues);
  ASSERT_TRUE(once.ok() && again.ok());
  EXPECT_EQ(once->parameters, again->parameters);
  EXPECT_EQ(once->objective, again->objective);
}

TEST(MapOptimizationTest, RefusesWhatCannotBe) {
  MapOptimization problem = Bowl();
  problem.starts = 0;
  EXPECT_EQ(Optimize(problem, BowlValues).status().code(), absl::StatusCode::kInvalidArgument);
  problem = Bowl();
  problem.lower(0) = 5;
  EXPECT_EQ(Optimize(problem, BowlValues).status().code(), absl::StatusCode::kInvalidArgument);
  problem = Bowl();
  problem.objective = Parsed("sqrt(0 - 1 - f)");
  EXPECT_EQ(Optimize(problem, BowlValues).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace mortise::interpolator
