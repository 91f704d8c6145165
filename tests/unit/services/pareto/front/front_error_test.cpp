#include "services/pareto/front/front_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

// f = |x - a|^2 and |x - b|^2: the Pareto set is the line from a to b.
Evaluation TwoBowls(const VectorXd& x) {
  const Vector2d a(0.2, 0.5), b(0.8, 0.5);
  Evaluation evaluation;
  evaluation.x = x;
  evaluation.status = EvaluationStatus::kEvaluated;
  evaluation.metrics = Vector2d((x - a).squaredNorm(), (x - b).squaredNorm());
  evaluation.jacobian.resize(2, 2);
  evaluation.jacobian << 2 * (x - a).transpose(), 2 * (x - b).transpose();
  return evaluation;
}

const DesignSpace kBowlBox{Vector2d::Zero(), Vector2d::Ones()};
const Scaling kNoScaling{Vector2d::Zero(), Vector2d::Ones()};

TEST(FrontError, IsNothingOnTheFront) {
  for (const double x : {0.2, 0.3, 0.5, 0.65, 0.8}) {
    const PushedDesign pushed = PushAlongNormal(kBowlBox, kNoScaling, TwoBowls, Vector2d(x, 0.5));
    EXPECT_NEAR(pushed.error, 0, 1e-12) << x;
    EXPECT_NEAR(pushed.x[1], 0.5, 1e-6) << x;
  }
}

// Half way the normal points along (1, 1), and a step e away from the line costs each metric e^2.
TEST(FrontError, IsTheDistanceFromTheFront) {
  for (const double e : {1e-3, 1e-2, 3e-2}) {
    const PushedDesign pushed =
        PushAlongNormal(kBowlBox, kNoScaling, TwoBowls, Vector2d(0.5, 0.5 + e));
    EXPECT_NEAR(pushed.error, std::sqrt(2.0) * e * e, 1e-3 * e * e) << e;
    EXPECT_NEAR((pushed.x - Vector2d(0.5, 0.5)).norm(), 0, 1e-6) << e;
  }
}

TEST(FrontError, IsMeasuredInScaledPerformance) {
  const Scaling scaling{Vector2d(1, 2), Vector2d(10, 10)};
  const double e = 0.01;
  const PushedDesign pushed = PushAlongNormal(kBowlBox, scaling, TwoBowls, Vector2d(0.5, 0.5 + e));
  EXPECT_NEAR(pushed.error, std::sqrt(2.0) * e * e / 10, 1e-3 * e * e);
}

// No design beyond the bound at x2 = 0.6 is possible, so those on it are on the front.
TEST(FrontError, KeepsToTheBounds) {
  const DesignSpace space{Vector2d(0, 0.6), Vector2d(1, 1)};
  for (const double above : {0.0, 0.02}) {
    const PushedDesign pushed =
        PushAlongNormal(space, kNoScaling, TwoBowls, Vector2d(0.5, 0.6 + above));
    EXPECT_EQ(pushed.x[1], 0.6);
    EXPECT_NEAR(pushed.error, std::sqrt(2.0) * ((0.1 + above) * (0.1 + above) - 0.01), 1e-9);
  }
}

TEST(FrontError, ReachesNoFurtherThanTheReferencePoint) {
  const PushedDesign pushed =
      PushAlongNormal(kBowlBox, kNoScaling, TwoBowls, Vector2d(0.5, 0.9), 0.03);
  EXPECT_NEAR(pushed.error, 0.03, 1e-6);
}

TEST(FrontError, IsUnknownWithoutGradients) {
  const auto evaluate = [](const VectorXd& x) {
    Evaluation evaluation = TwoBowls(x);
    evaluation.jacobian(0, 0) = std::numeric_limits<double>::infinity();
    return evaluation;
  };
  const PushedDesign pushed = PushAlongNormal(kBowlBox, kNoScaling, evaluate, Vector2d(0.5, 0.6));
  EXPECT_TRUE(std::isnan(pushed.error));
  EXPECT_EQ(pushed.x, Vector2d(0.5, 0.6));
}

TEST(FrontError, IsGivenForEachPointOfAFront) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("DTLZ2", 5);
  const auto evaluate = [&](const VectorXd& x) { return problem.evaluate(x, true); };
  Front front;
  front.scaling = {VectorXd::Zero(3), VectorXd::Ones(3)};
  for (const double distance : {0.0, 1e-3, 0.05}) {
    VectorXd x(5);
    x << 0.3, 0.6, 0.5 + distance, 0.5, 0.5;
    front.points.push_back({.x = x, .metrics = evaluate(x).metrics, .embedding = {}});
  }
  const std::vector<double> errors = FrontErrors(problem.space, front, evaluate);
  ASSERT_EQ(errors.size(), 3u);
  EXPECT_NEAR(errors[0], 0, 1e-12);
  EXPECT_NEAR(errors[1], 1e-6, 1e-10);
  EXPECT_NEAR(errors[2], 0.0025, 1e-6);
}

}  // namespace
}  // namespace mortise::pareto
