#include "services/pareto/front/piece_evaluation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "services/pareto/archive/hypervolume.h"
#include "services/pareto/archive/non_dominated.h"
#include "tests/bench/pareto/benchmark_run.h"

namespace mortise::pareto {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Shares {
  double archive = 0;
  double dense = 0;
};

Shares SharesWithGradients(const BenchmarkProblem& problem, std::int64_t evaluations) {
  Discovery::Options options;
  options.evaluations = evaluations;
  options.stall_tracks = 0;
  const BenchmarkResult result = *RunBenchmark(problem, options, true);
  const PieceEvaluation pieces = EvaluatePieces(
      problem.space, result.front, [&](const VectorXd& x) { return problem.evaluate(x, false); },
      {.designs = 20'000});
  EXPECT_GT(pieces.evaluations, 0);
  return {result.hypervolume / problem.hypervolume,
          Hypervolume(pieces.metrics, problem.reference) / problem.hypervolume};
}

// One affine subspace is the whole Pareto set, however few of its designs were evaluated.
TEST(PieceEvaluation, RepresentsAnAffineParetoSetWithFewPoints) {
  const Shares zdt1 = SharesWithGradients(*MakeBenchmarkProblem("ZDT1", 30), 60);
  EXPECT_GT(zdt1.dense, 0.999);
  EXPECT_LT(zdt1.archive, 0.99);
  // Twenty thousand designs on a surface are 0.01 apart, which costs that of the volume.
  const Shares dtlz2 = SharesWithGradients(*MakeBenchmarkProblem("DTLZ2", 5), 400);
  EXPECT_GT(dtlz2.dense, 0.99);
  EXPECT_LE(dtlz2.dense, 1);
  EXPECT_LT(dtlz2.archive, 0.97);
}

TEST(PieceEvaluation, DoesNotMindDominatedStretches) {
  const Shares zdt3 = SharesWithGradients(*MakeBenchmarkProblem("ZDT3", 10), 300);
  EXPECT_GT(zdt3.dense, zdt3.archive);
  EXPECT_GT(zdt3.dense, 0.9995);
  EXPECT_LE(zdt3.dense, 1 + 1e-6);
}

// f = (x1, 1 - x1 + x2), x2 in [0, 1]: the Pareto set is where x2 = 0.
Evaluation Slope(const VectorXd& x) {
  Evaluation evaluation;
  evaluation.x = x;
  evaluation.status = EvaluationStatus::kEvaluated;
  evaluation.metrics = Vector2d(x[0], 1 - x[0] + x[1]);
  return evaluation;
}

Front FrontOf(const DesignSpace& space, const std::vector<VectorXd>& designs,
              const Eigen::MatrixXd& directions,
              const std::function<Evaluation(const VectorXd&)>& evaluate) {
  Front front;
  front.scaling = {Vector2d::Zero(), Vector2d::Ones()};
  for (const VectorXd& x : designs) {
    front.points.push_back({.x = x,
                            .metrics = evaluate(x).metrics,
                            .embedding = VectorXd::Constant(1, 1 - space.ToUnit(x)[0])});
  }
  std::ranges::reverse(front.points);
  front.pieces.push_back({designs.front(), directions, static_cast<int>(designs.size())});
  return front;
}

TEST(PieceEvaluation, GoesLittleFurtherThanThePoints) {
  const DesignSpace space{Vector2d(0, 0), Vector2d(2, 1)};
  const Front front =
      FrontOf(space, {Vector2d(0.8, 0), Vector2d(1.0, 0), Vector2d(1.2, 0)}, Vector2d(2, 0), Slope);
  const PieceEvaluation pieces = EvaluatePieces(space, front, Slope, {.spacing = 0.01});
  double least = 2, most = 0;
  for (const VectorXd& metrics : pieces.metrics) {
    least = std::min(least, metrics[0]);
    most = std::max(most, metrics[0]);
    EXPECT_NEAR(metrics[1], 1 - metrics[0], 1e-12);
  }
  EXPECT_NEAR(least, 0.6, 1e-12);
  EXPECT_NEAR(most, 1.4, 1e-12);
  EXPECT_GT(pieces.evaluations, 80);
  EXPECT_LT(pieces.evaluations, 400);
}

TEST(PieceEvaluation, StaysWithinTheBox) {
  const DesignSpace space{Vector2d(0, 0), Vector2d(2, 1)};
  const Front front = FrontOf(space, {Vector2d(0.1, 0.1), Vector2d(1.0, 0.05), Vector2d(1.9, 0)},
                              Vector2d(2, -0.1), Slope);
  const PieceEvaluation pieces = EvaluatePieces(space, front, [&](const VectorXd& x) {
    EXPECT_TRUE((x.array() >= space.lower.array()).all());
    EXPECT_TRUE((x.array() <= space.upper.array()).all());
    return Slope(x);
  });
  EXPECT_GT(pieces.evaluations, 100);
}

TEST(PieceEvaluation, GoesStraightBetweenPointsOnNoSubspace) {
  const DesignSpace space{Vector2d(0, 0), Vector2d(1, 1)};
  const Front front = FrontOf(space, {Vector2d(0, 0), Vector2d(0.5, 0.1), Vector2d(1, 0)},
                              Eigen::MatrixXd(2, 0), Slope);
  const PieceEvaluation pieces = EvaluatePieces(space, front, Slope, {.spacing = 0.01});
  EXPECT_GT(pieces.evaluations, 50);
  for (const VectorXd& metrics : pieces.metrics) {
    EXPECT_NEAR(metrics[1], 1 - metrics[0] + 0.1 - 0.2 * std::abs(metrics[0] - 0.5), 1e-12);
  }
}

TEST(PieceEvaluation, LeavesOutWhatFailsOrViolatesConstraints) {
  const auto evaluate = [](const VectorXd& x) {
    Evaluation evaluation = Slope(x);
    if (x[0] > 0.7) return Evaluation{};
    evaluation.constraints = VectorXd::Constant(1, 0.25 - x[0]);
    return evaluation;
  };
  const DesignSpace space{Vector2d(0, 0), Vector2d(1, 1)};
  Front front = FrontOf(space, {Vector2d(0, 0), Vector2d(0.3, 0), Vector2d(0.5, 0)}, Vector2d(1, 0),
                        evaluate);
  front.points.pop_back();  // the first of them is not feasible
  const PieceEvaluation pieces = EvaluatePieces(space, front, evaluate, {.spacing = 0.01});
  EXPECT_GT(pieces.metrics.size(), 10u);
  for (const VectorXd& metrics : pieces.metrics) {
    EXPECT_GE(metrics[0], 0.25);
    EXPECT_LE(metrics[0], 0.7);
  }
}

TEST(PieceEvaluation, UsesNoMoreDesignsThanGiven) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("DTLZ2", 3);
  Discovery::Options options;
  options.evaluations = 40;
  const BenchmarkResult result = *RunBenchmark(problem, options, true);
  std::int64_t count = 0;
  const PieceEvaluation pieces = EvaluatePieces(problem.space, result.front,
                                                [&](const VectorXd& x) {
                                                  ++count;
                                                  return problem.evaluate(x, false);
                                                },
                                                {.designs = 500});
  EXPECT_EQ(pieces.evaluations, count);
  EXPECT_LE(count, 500);
}

TEST(PieceEvaluation, HasNothingToSayOfAnEmptyFront) {
  const DesignSpace space{Vector2d(0, 0), Vector2d(1, 1)};
  const PieceEvaluation pieces = EvaluatePieces(space, {}, Slope);
  EXPECT_EQ(pieces.evaluations, 0);
  EXPECT_TRUE(pieces.metrics.empty());
}

}  // namespace
}  // namespace mortise::pareto
