// Which designs of earlier fronts a discovery begins with, and what comes of it.
#include "services/pareto/discovery/warm_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/base/errors.h"
#include "services/pareto/discovery/discovery.h"
#include "tests/bench/pareto/benchmark_problems.h"
#include "tests/bench/pareto/benchmark_run.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

DesignSpace UnitSquare() { return {VectorXd::Zero(2), VectorXd::Ones(2)}; }

// n points of a quarter circle, crowded at one end; designs are (t, 1 - t).
EarlierFront QuarterCircle(Eigen::Index n) {
  EarlierFront front{MatrixXd(2, n), MatrixXd(2, n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = std::pow(static_cast<double>(i) / static_cast<double>(n - 1), 3);
    front.designs.col(i) << t, 1 - t;
    front.metrics.col(i) << 1 - std::cos(t * M_PI / 2), 1 - std::sin(t * M_PI / 2);
  }
  return front;
}

TEST(WarmStartTest, SpreadsAlongTheFront) {
  const EarlierFront front = QuarterCircle(500);
  const MatrixXd designs = StartDesigns(UnitSquare(), {front}, 9);
  ASSERT_EQ(designs.cols(), 9);
  EXPECT_EQ(designs(0, 0), 0) << "the best of the first metric";
  EXPECT_EQ(designs(0, 1), 1) << "the best of the second";
  std::set<double> sorted(designs.row(0).begin(), designs.row(0).end());
  double last = 0, widest = 0;
  for (const double t : sorted) {
    widest = std::max(widest, t - last);
    last = t;
  }
  EXPECT_LT(widest, 0.26);  // an eighth each would be best
  EXPECT_EQ(StartDesigns(UnitSquare(), {front}, 9), designs);
}

TEST(WarmStartTest, KeepsToBoundsAndStepsAndTakesNoneTwice) {
  DesignSpace space{Eigen::Vector2d(0.2, 0), Eigen::Vector2d(0.7, 1), Eigen::Vector2d(0.1, 0)};
  const MatrixXd designs = StartDesigns(space, {QuarterCircle(50), QuarterCircle(50)}, 1000);
  std::set<std::vector<double>> different;
  for (const auto& x : designs.colwise()) {
    EXPECT_EQ(x, space.Nearest(x));
    EXPECT_GE(x[0], 0.2);
    EXPECT_LE(x[0], 0.7);
    EXPECT_NEAR(std::remainder(x[0] - 0.2, 0.1), 0, 1e-12);
    EXPECT_TRUE(different.emplace(x.begin(), x.end()).second);
  }
  EXPECT_EQ(designs.cols(), 50) << "the fronts are the same";
}

TEST(WarmStartTest, GivesEachFrontItsPart) {
  EarlierFront other = QuarterCircle(100);
  other.designs.row(1).setConstant(0.25);
  const MatrixXd designs = StartDesigns(UnitSquare(), {QuarterCircle(100), other}, 20);
  EXPECT_EQ(designs.cols(), 20);
  EXPECT_EQ((designs.row(1).array() == 0.25).count(), 10);
}

// The second and the third are equally good in the first metric; only the third is not dominated.
TEST(WarmStartTest, TakesTheEndThatNoneDominates) {
  EarlierFront front;
  front.designs = MatrixXd{{0.1, 0.2, 0.3, 0.4}, {0, 0, 0, 0}};
  front.metrics = MatrixXd{{2, 1, 1, 3}, {2, 5, 4, 1}};
  const MatrixXd designs = StartDesigns(UnitSquare(), {front}, 2);
  EXPECT_EQ(designs, (MatrixXd{{0.3, 0.4}, {0, 0}}));
}

TEST(WarmStartTest, LeavesMostOfTheBudget) {
  EXPECT_EQ(MostStartDesigns(10'000, 2), 24);
  EXPECT_EQ(MostStartDesigns(10'000, 3), 96);
  EXPECT_EQ(MostStartDesigns(80, 2), 10);
  EXPECT_EQ(MostStartDesigns(10, 2), 1);
}

TEST(WarmStartTest, DesignsGivenAreTheFirstBitForBit) {
  DesignSpace space{Eigen::Vector3d(0.1, 0.3, 2), Eigen::Vector3d(0.7, 1.1, 2)};
  MatrixXd given(3, 4);
  given << 0.1, 0.1234567890123, 1.0 / 3, 0.7,  //
      0.3, 0.77777777777777, 0.987654321, 1.1,  //
      2, 2, 2, 2;
  Discovery::Options options;
  options.evaluations = 40;
  options.initial_designs = given;
  const auto discovery = *Discovery::Create(space, 2, options);
  std::vector<VectorXd> asked;
  while (!discovery->Finished()) {
    const auto proposal = discovery->Ask();
    if (!proposal) continue;
    asked.push_back(proposal->x);
    Evaluation evaluation;
    evaluation.x = proposal->x;
    evaluation.status = EvaluationStatus::kEvaluated;
    evaluation.metrics = Eigen::Vector2d(proposal->x[0], 1 - proposal->x[0] + proposal->x[1]);
    ASSERT_TRUE(discovery->Tell(proposal->number, evaluation).ok());
  }
  ASSERT_EQ(asked.size(), 40u);
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_EQ(asked[static_cast<std::size_t>(i)], given.col(i));
  // Points of the front are what was evaluated, bit for bit.
  for (const FrontPoint& point : discovery->front().points) {
    EXPECT_NE(std::ranges::find(asked, point.x), asked.end());
  }
}

TEST(WarmStartTest, FindsAMovedFrontSoon) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT1", 15, {.shifted = true});
  Discovery::Options options;
  options.evaluations = 1000;
  options.surrogate = Discovery::Surrogate::kNever;
  const BenchmarkResult before = *RunBenchmark(problem, options, false);
  EarlierFront earlier;
  const auto count = static_cast<Eigen::Index>(before.front.points.size());
  earlier.designs.resize(15, count);
  earlier.metrics.resize(2, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    earlier.designs.col(i) = before.front.points[static_cast<std::size_t>(i)].x;
    earlier.metrics.col(i) = before.front.points[static_cast<std::size_t>(i)].metrics;
  }
  options.evaluations = 200;
  const double cold = RunBenchmark(problem, options, false)->hypervolume;
  options.initial_designs = StartDesigns(problem.space, {earlier}, MostStartDesigns(200, 2));
  const double warm = RunBenchmark(problem, options, false)->hypervolume;
  EXPECT_GT(warm, 0.95 * problem.hypervolume);
  EXPECT_GT(warm, cold);
}

TEST(WarmStartTest, RefusesDesignsThatDoNotFit) {
  const auto fault = [](const MatrixXd& designs) {
    Discovery::Options options;
    options.evaluations = 20;
    options.initial_designs = designs;
    return DetailOf(Discovery::Create(UnitSquare(), 2, options).status()).field;
  };
  EXPECT_EQ(fault(MatrixXd::Constant(2, 3, 0.5)), "");
  EXPECT_EQ(fault(MatrixXd::Constant(3, 3, 0.5)), "initial_designs");
  EXPECT_EQ(fault(MatrixXd::Constant(2, 20, 0.5)), "initial_designs");
  EXPECT_EQ(fault(MatrixXd::Constant(2, 1, 1.5)), "initial_designs[0]");
  EXPECT_EQ(fault(MatrixXd::Constant(2, 1, std::nan(""))), "initial_designs[0]");
}

}  // namespace
}  // namespace mortise::pareto
