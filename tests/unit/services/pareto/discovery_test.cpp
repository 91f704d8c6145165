// Discovery on problems with known fronts, and what it does with bad input.
#include "services/pareto/discovery.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/pareto/benchmark_problems.h"
#include "services/pareto/hypervolume.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

std::unique_ptr<Discovery> Complete(const DesignSpace& space, Eigen::Index d,
                                    const Discovery::Options& options,
                                    const std::function<Evaluation(const VectorXd&)>& evaluate) {
  auto discovery = *Discovery::Create(space, d, options);
  while (!discovery->Finished()) {
    const auto proposal = discovery->Ask();
    if (!proposal) continue;
    EXPECT_TRUE((proposal->x.array() >= space.lower.array()).all());
    EXPECT_TRUE((proposal->x.array() <= space.upper.array()).all());
    EXPECT_TRUE(discovery->Tell(proposal->number, evaluate(proposal->x)).ok());
  }
  return discovery;
}

double Share(const std::string& name, int dimensions, std::int64_t evaluations, bool gradients) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem(name, dimensions);
  Discovery::Options options;
  options.evaluations = evaluations;
  const auto discovery =
      Complete(problem.space, problem.metric_count, options,
               [&](const VectorXd& x) { return problem.evaluate(x, gradients); });
  std::vector<VectorXd> points;
  for (const FrontPoint& point : discovery->front().points) points.push_back(point.metrics);
  return Hypervolume(points, problem.reference) / problem.hypervolume;
}

TEST(DiscoveryTest, FindsZdt1WithoutGradients) { EXPECT_GT(Share("ZDT1", 15, 1000, false), 0.98); }

TEST(DiscoveryTest, FindsZdt2WithoutGradients) { EXPECT_GT(Share("ZDT2", 15, 1000, false), 0.98); }

TEST(DiscoveryTest, FindsZdt1WithGradients) { EXPECT_GT(Share("ZDT1", 15, 300, true), 0.98); }

// A frame of beams: legs of section a, rails of height b and a plate of thickness t; deflection of
// a plate on rails in closed form. Length, width and height are free, too.
Evaluation Table(const VectorXd& x) {
  const double length = x[0], width = x[1], height = x[2], leg = x[3], apron = x[4], top = x[5];
  const double density = 700, modulus = 10e9, load = 1000, rail = 0.02;
  Evaluation evaluation;
  evaluation.x = x;
  evaluation.status = EvaluationStatus::kFeasible;
  const double mass = density * (length * width * top + 4 * leg * leg * height +
                                 2 * rail * apron * (length + width));
  const double bending = width * std::pow(top, 3) / 12 + rail * std::pow(apron, 3) / 6;
  const double deflection =
      load * std::pow(length, 3) / (48 * modulus * bending) +
      load * height / (4 * modulus * leg * leg) +
      load * 0.05 * std::pow(height, 3) / (3 * modulus * 4 * std::pow(leg, 4) / 12);
  evaluation.metrics = Eigen::Vector2d(mass, deflection);
  return evaluation;
}

TEST(DiscoveryTest, SpreadsOverTheTradeOffsOfATableIn150Evaluations) {
  VectorXd lower(6), upper(6);
  lower << 0.8, 0.5, 0.6, 0.03, 0.04, 0.012;
  upper << 1.6, 0.9, 0.8, 0.09, 0.15, 0.04;
  Discovery::Options options;
  options.evaluations = 150;
  options.window = 4;
  const auto discovery = Complete({lower, upper}, 2, options, Table);
  const Front front = discovery->front();
  EXPECT_GE(front.points.size(), 20u);
  options.evaluations = 5000;
  const auto longer = Complete({lower, upper}, 2, options, Table);
  const Scaling scaling = longer->archive().CurrentScaling();
  const auto dominated = [&](const Front& of) {
    std::vector<VectorXd> points;
    for (const FrontPoint& point : of.points) points.push_back(scaling.Apply(point.metrics));
    return Hypervolume(points, VectorXd::Constant(2, 1.1));
  };
  EXPECT_GT(dominated(front), 0.95 * dominated(longer->front()));
}

TEST(DiscoveryTest, FindsThePiecesOfKursawe) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("Kursawe", 3);
  Discovery::Options options;
  const auto discovery = Complete(problem.space, 2, options,
                                  [&](const VectorXd& x) { return problem.evaluate(x, false); });
  std::vector<VectorXd> points;
  for (const FrontPoint& point : discovery->front().points) points.push_back(point.metrics);
  // 38.0 is what 20,000 evaluations with gradients dominate.
  EXPECT_GT(Hypervolume(points, problem.reference), 0.85 * 38.0);
}

TEST(DiscoveryTest, FrontPointsAreEvaluatedNonDominatedAndWithinBounds) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("DTLZ2", 7);
  Discovery::Options options;
  options.evaluations = 400;
  const auto discovery = Complete(problem.space, 3, options,
                                  [&](const VectorXd& x) { return problem.evaluate(x, true); });
  const Front front = discovery->front();
  ASSERT_FALSE(front.points.empty());
  for (const FrontPoint& point : front.points) {
    EXPECT_EQ(problem.evaluate(point.x, false).metrics, point.metrics);
    EXPECT_EQ(point.embedding.size(), 2);
    EXPECT_GE(point.embedding.minCoeff(), 0);
    EXPECT_LE(point.embedding.maxCoeff(), 1);
    EXPECT_GE(point.piece, 0);
    EXPECT_LT(point.piece, front.pieces);
  }
}

TEST(DiscoveryTest, CountsFailingEvaluationsAndGoesOn) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT1", 5);
  Discovery::Options options;
  options.evaluations = 300;
  std::int64_t failed = 0;
  const auto discovery = Complete(problem.space, 2, options, [&](const VectorXd& x) {
    Evaluation evaluation = problem.evaluate(x, false);
    if (x[1] > 0.3 && x[1] < 0.5) {
      evaluation.status = EvaluationStatus::kFailed;
      ++failed;
    } else if (x[2] > 0.8) {
      evaluation.metrics[0] = std::numeric_limits<double>::quiet_NaN();
      ++failed;
    }
    return evaluation;
  });
  EXPECT_GT(failed, 0);
  EXPECT_EQ(discovery->summary().failed, failed);
  EXPECT_EQ(discovery->summary().evaluations, 300);
  EXPECT_FALSE(discovery->front().points.empty());
}

TEST(DiscoveryTest, EndsWithAnEmptyFrontWhenEverythingFails) {
  Discovery::Options options;
  options.evaluations = 50;
  const auto discovery =
      Complete({VectorXd::Zero(2), VectorXd::Ones(2)}, 2, options, [](const VectorXd& x) {
        Evaluation evaluation;
        evaluation.x = x;
        return evaluation;
      });
  EXPECT_EQ(discovery->summary().stop_reason, Discovery::StopReason::kBudget);
  EXPECT_TRUE(discovery->front().points.empty());
}

TEST(DiscoveryTest, CopesWithConstantEqualAndSingleMetricsAndFixedParameters) {
  Discovery::Options options;
  options.evaluations = 60;
  const DesignSpace space{Eigen::Vector2d(0, 3), Eigen::Vector2d(1, 3)};
  for (const int shape : {0, 1, 2}) {
    const auto discovery = Complete(space, 2, options, [&](const VectorXd& x) {
      Evaluation evaluation;
      evaluation.x = x;
      evaluation.status = EvaluationStatus::kFeasible;
      EXPECT_EQ(x[1], 3);
      const double f = x[0] * x[0];
      evaluation.metrics = shape == 0   ? Eigen::Vector2d(1, 1)
                           : shape == 1 ? Eigen::Vector2d(f, f)
                                        : Eigen::Vector2d(f, 5);
      return evaluation;
    });
    ASSERT_FALSE(discovery->front().points.empty());
    if (shape > 0) {
      EXPECT_LT(discovery->front().points.front().metrics[0], 1e-6);
    }
  }
}

TEST(DiscoveryTest, SetsOnlyWhatAWorkshopCanSet) {
  const DesignSpace space{VectorXd::Zero(2), VectorXd::Constant(2, 1), VectorXd::Constant(2, 0.3)};
  Discovery::Options options;
  options.evaluations = 100;
  std::int64_t evaluated = 0;
  const auto discovery = Complete(space, 2, options, [&](const VectorXd& x) {
    ++evaluated;
    for (const double value : x) EXPECT_NEAR(std::round(value / 0.3) * 0.3, value, 1e-12);
    Evaluation evaluation;
    evaluation.x = x;
    evaluation.status = EvaluationStatus::kFeasible;
    evaluation.metrics = Eigen::Vector2d(x[0] + x[1], 2 - x[0]);
    return evaluation;
  });
  EXPECT_EQ(discovery->summary().stop_reason, Discovery::StopReason::kConverged);
  EXPECT_LE(evaluated, 40);
  EXPECT_EQ(discovery->front().points.size(), 4u);
}

TEST(DiscoveryTest, NamesTheFieldOfBadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto create = [](double lower, double upper, Eigen::Index d, std::int64_t evaluations) {
    Discovery::Options options;
    options.evaluations = evaluations;
    return Discovery::Create({VectorXd::Constant(2, lower), VectorXd::Constant(2, upper)}, d,
                             options)
        .status();
  };
  EXPECT_TRUE(create(0, 1, 2, 10).ok());
  EXPECT_TRUE(absl::IsInvalidArgument(create(nan, 1, 2, 10)));
  EXPECT_TRUE(absl::IsInvalidArgument(create(1, 0, 2, 10)));
  EXPECT_TRUE(absl::IsInvalidArgument(create(-1e308, 1e308, 2, 10)));
  EXPECT_TRUE(absl::IsInvalidArgument(create(0, 1, 0, 10)));
  EXPECT_TRUE(absl::IsInvalidArgument(create(0, 1, 2, 0)));
  EXPECT_TRUE(absl::IsInvalidArgument(
      Discovery::Create({VectorXd::Zero(513), VectorXd::Ones(513)}, 2, {}).status()));
}

TEST(DiscoveryTest, RefusesResultsThatDoNotBelong) {
  auto discovery = *Discovery::Create({VectorXd::Zero(2), VectorXd::Ones(2)}, 2, {});
  const auto proposal = discovery->Ask();
  ASSERT_TRUE(proposal);
  Evaluation evaluation;
  evaluation.x = proposal->x;
  evaluation.status = EvaluationStatus::kFeasible;
  evaluation.metrics = VectorXd::Ones(3);
  EXPECT_TRUE(absl::IsInvalidArgument(discovery->Tell(0, evaluation)));
  evaluation.metrics = VectorXd::Ones(2);
  EXPECT_TRUE(absl::IsInvalidArgument(discovery->Tell(7, evaluation)));
  evaluation.x[0] += 0.1;
  EXPECT_TRUE(absl::IsInvalidArgument(discovery->Tell(0, evaluation)));
  evaluation.x = proposal->x;
  EXPECT_TRUE(discovery->Tell(0, evaluation).ok());
  EXPECT_TRUE(absl::IsInvalidArgument(discovery->Tell(0, evaluation)));
}

}  // namespace
}  // namespace mortise::pareto
