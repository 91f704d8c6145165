// Discovery on problems with known fronts, and what it does with bad input.
#include "services/pareto/discovery/discovery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/pareto/archive/hypervolume.h"
#include "tests/bench/pareto/benchmark_problems.h"

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

double Share(const std::string& name, int dimensions, std::int64_t evaluations, bool gradients,
             std::uint64_t seed = 1) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem(name, dimensions);
  Discovery::Options options;
  options.evaluations = evaluations;
  options.surrogate = Discovery::Surrogate::kNever;
  options.seed = seed;
  const auto discovery =
      Complete(problem.space, problem.metric_count, options,
               [&](const VectorXd& x) { return problem.evaluate(x, gradients); });
  std::vector<VectorXd> points;
  for (const FrontPoint& point : discovery->front().points) points.push_back(point.metrics);
  return Hypervolume(points, problem.reference) / problem.hypervolume;
}

TEST(DiscoveryTest, FindsZdt1AndZdt2WithoutGradients) {
  for (const std::uint64_t seed : {1, 2}) {
    EXPECT_GT(Share("ZDT1", 15, 1000, false, seed), 0.98) << seed;
    EXPECT_GT(Share("ZDT2", 15, 1000, false, seed), 0.98) << seed;
  }
}

TEST(DiscoveryTest, FindsZdt1AndZdt2WithGradients) {
  for (const std::uint64_t seed : {1, 2}) {
    EXPECT_GT(Share("ZDT1", 15, 300, true, seed), 0.98) << seed;
    EXPECT_GT(Share("ZDT2", 15, 300, true, seed), 0.98) << seed;
  }
}

// ZDT2's best design in the first metric is stationary in the second: where it dominates all that
// is known, nothing leads on from it.
TEST(DiscoveryTest, LeavesADesignThatDominatesAllOthers) {
  for (const std::uint64_t seed : {8, 21, 22}) {
    EXPECT_GT(Share("ZDT2", 15, 300, true, seed), 0.98) << seed;
  }
}

// With 20^9 and 10^5 local fronts.
TEST(DiscoveryTest, LeavesLocalOptimaHoweverMany) {
  for (const std::uint64_t seed : {1, 2}) {
    EXPECT_GT(Share("ZDT4", 10, 6000, false, seed), 0.95) << seed;
    EXPECT_GT(Share("DTLZ1", 7, 4000, false, seed), 0.9) << seed;
  }
}

// A table as the demo has it: length, width, height, and the sizes of legs,
// apron and top. Mass with its gradient, deflection of a plate on rails (closed
// form) without.
Evaluation Table(const VectorXd& x) {
  const double length = x[0], width = x[1], height = x[2], leg = x[3], apron = x[4], top = x[5];
  const double density = 700, modulus = 10e9, load = 1000, rail = 0.02;
  Evaluation evaluation;
  evaluation.x = x;
  evaluation.status = EvaluationStatus::kEvaluated;
  const double mass = density * (length * width * top + 4 * leg * leg * height +
                                 2 * rail * apron * (length + width));
  const double bending = width * std::pow(top, 3) / 12 + rail * std::pow(apron, 3) / 6;
  const double deflection =
      load * std::pow(length, 3) / (48 * modulus * bending) +
      load * height / (4 * modulus * leg * leg) +
      load * 0.05 * std::pow(height, 3) / (3 * modulus * 4 * std::pow(leg, 4) / 12);
  evaluation.metrics = Eigen::Vector2d(mass, deflection);
  evaluation.jacobian.setConstant(2, 6, std::numeric_limits<double>::quiet_NaN());
  evaluation.jacobian.row(0) << width * top + 2 * rail * apron, length * top + 2 * rail * apron,
      4 * leg * leg, 8 * leg * height, 2 * rail * (length + width), length * width;
  evaluation.jacobian.row(0) *= density;
  return evaluation;
}

// Length and width are what the user asked for; the other four are free.
DesignSpace TableSpace() {
  DesignSpace space{VectorXd(6), VectorXd(6)};
  space.lower << 1.2, 0.7, 0.6, 0.03, 0.04, 0.012;
  space.upper << 1.2, 0.7, 0.8, 0.09, 0.15, 0.04;
  return space;
}

// The non-dominated designs of a dense grid, by ascending mass. Both metrics
// grow with the height, which is therefore least all along the front.
std::vector<VectorXd> TableFrontOfAGrid() {
  constexpr int kParts = 60;
  const DesignSpace space = TableSpace();
  std::vector<std::pair<double, double>> all;
  VectorXd u = VectorXd::Zero(6);
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      for (int k = 0; k <= kParts; ++k) {
        u.tail(3) << i, j, k;
        const VectorXd metrics =
            Table(space.lower + (u / kParts).cwiseProduct(space.upper - space.lower)).metrics;
        all.emplace_back(metrics[0], metrics[1]);
      }
    }
  }
  std::sort(all.begin(), all.end());
  std::vector<VectorXd> front;
  for (const auto& [mass, deflection] : all) {
    if (front.empty() || deflection < front.back()[1]) {
      front.push_back(Eigen::Vector2d(mass, deflection));
    }
  }
  return front;
}

struct Coverage {
  double share = 0;       // of the hypervolume that the grid's front dominates
  double widest_gap = 0;  // between neighbours, scaled so that the grid's front spans 1 x 1
  std::size_t points = 0;
};

class TableTest : public testing::Test {
 protected:
  Coverage Cover(std::int64_t evaluations, std::uint64_t seed, double roughness) const {
    Discovery::Options options;
    options.evaluations = evaluations;
    options.window = 4;
    options.seed = seed;
    const auto discovery = Complete(TableSpace(), 2, options, [&](const VectorXd& x) {
      Evaluation evaluation = Table(x);
      evaluation.metrics[1] *= 1 + roughness * std::sin(1e5 * x.sum());
      return evaluation;
    });
    std::vector<VectorXd> found;
    for (const FrontPoint& point : discovery->front().points) found.push_back(point.metrics);
    Coverage coverage{Dominated(found) / Dominated(truth_), 0, found.size()};
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a[0] < b[0]; });
    for (std::size_t i = 0; i + 1 < found.size(); ++i) {
      const Eigen::Vector2d gap = (found[i + 1] - found[i]).cwiseQuotient(range_);
      coverage.widest_gap = std::max(coverage.widest_gap, gap.norm());
    }
    return coverage;
  }

 private:
  double Dominated(std::vector<VectorXd> points) const {
    for (VectorXd& point : points) point = (point - ideal_).cwiseQuotient(range_).eval();
    return Hypervolume(points, VectorXd::Constant(2, 1.1));
  }

  const std::vector<VectorXd> truth_ = TableFrontOfAGrid();
  const Eigen::Vector2d ideal_{truth_.front()[0], truth_.back()[1]};
  const Eigen::Vector2d range_{truth_.back()[0] - ideal_[0], truth_.front()[1] - ideal_[1]};
};

// What the demo asks for; a finite-element deflection is a little rough.
TEST_F(TableTest, SpreadsOverTheTradeOffsIn150Evaluations) {
  for (const double roughness : {0.0, 0.01}) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      const Coverage coverage = Cover(150, seed, roughness);
      EXPECT_GT(coverage.share, 0.985) << "seed " << seed << " roughness " << roughness;
      EXPECT_LT(coverage.widest_gap, 0.2) << "seed " << seed << " roughness " << roughness;
      EXPECT_GE(coverage.points, roughness > 0 ? 35u : 40u)
          << "seed " << seed << " roughness " << roughness;
    }
  }
}

TEST_F(TableTest, ReachesTheFrontWithASurrogateInAThirdOfThem) {
  for (const double roughness : {0.0, 0.01}) {
    const Coverage coverage = Cover(50, 1, roughness);
    EXPECT_GT(coverage.share, 0.97) << "roughness " << roughness;
    EXPECT_GE(coverage.points, 12u) << "roughness " << roughness;
  }
}

TEST_F(TableTest, GivesASensibleFrontInAFewEvaluations) {
  for (const std::int64_t evaluations : {24, 30}) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      const Coverage coverage = Cover(evaluations, seed, 0);
      EXPECT_GT(coverage.share, 0.8) << evaluations << " evaluations, seed " << seed;
      EXPECT_GE(coverage.points, 5u) << evaluations << " evaluations, seed " << seed;
    }
  }
}

// Kursawe's front has no closed form. 37.3476 is what the non-dominated designs of a grid of 81
// designs a side dominate after 20 rounds of random perturbation at scales from 0.1 to 1e-4. Its
// many local fronts make how much of that a run finds depend on its seed.
TEST(DiscoveryTest, FindsMostOfKursawesFront) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("Kursawe", 3);
  for (const std::uint64_t seed : {1, 2, 3}) {
    Discovery::Options options;
    options.seed = seed;
    const auto discovery = Complete(problem.space, 2, options,
                                    [&](const VectorXd& x) { return problem.evaluate(x, false); });
    std::vector<VectorXd> points;
    for (const FrontPoint& point : discovery->front().points) points.push_back(point.metrics);
    EXPECT_GT(Hypervolume(points, problem.reference), 0.5 * problem.hypervolume) << "seed " << seed;
    EXPECT_LT(Hypervolume(points, problem.reference), 1.001 * problem.hypervolume)
        << "seed " << seed;
  }
}

TEST(DiscoveryTest, FrontPointsAreEvaluatedNonDominatedAndWithinBounds) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("DTLZ2", 7);
  Discovery::Options options;
  options.evaluations = 400;
  options.surrogate = Discovery::Surrogate::kNever;
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
    EXPECT_LT(static_cast<std::size_t>(point.piece), front.pieces.size());
  }
}

TEST(DiscoveryTest, CountsFailingEvaluationsAndGoesOn) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT1", 5);
  Discovery::Options options;
  options.surrogate = Discovery::Surrogate::kNever;
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
      evaluation.status = EvaluationStatus::kEvaluated;
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
    evaluation.status = EvaluationStatus::kEvaluated;
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
    options.surrogate = Discovery::Surrogate::kNever;
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
  evaluation.status = EvaluationStatus::kEvaluated;
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

TEST(DiscoveryTest, KeepsWhyDesignsFailed) {
  Discovery::Options options;
  options.evaluations = 40;
  auto discovery = *Discovery::Create({Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1)}, 2, options);
  while (const auto proposal = discovery->Ask()) {
    Evaluation evaluation;
    evaluation.x = proposal->x;
    evaluation.reason = "TOO_WIDE";
    evaluation.message = "too wide";
    evaluation.code = absl::StatusCode::kFailedPrecondition;
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
