// The benchmark problems' published optima, and their gradients against differences.
#include "tests/bench/pareto/benchmark_problems.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/hypervolume.h"

namespace mortise::pareto {
namespace {

bool HasVariants(const std::string& name) {
  return name.starts_with("ZDT") || name.starts_with("DTLZ");
}

std::vector<BenchmarkProblem> AllProblems() {
  std::vector<BenchmarkProblem> problems;
  for (const std::string& name : BenchmarkNames()) {
    const int dimensions = std::min(7, PublishedDimensions(name));
    problems.push_back(*MakeBenchmarkProblem(name, dimensions));
    if (!HasVariants(name)) continue;
    for (const auto& [shifted, rotated] :
         {std::pair(true, false), std::pair(false, true), std::pair(true, true)}) {
      problems.push_back(*MakeBenchmarkProblem(name, dimensions, {shifted, rotated, 3}));
    }
  }
  problems.push_back(*MakeBenchmarkProblem("Fourier", 4, {.instance = 2, .metrics = 3}));
  return problems;
}

// Metrics, then constraints.
Eigen::VectorXd Values(const Evaluation& evaluation) {
  Eigen::VectorXd values(evaluation.metrics.size() + evaluation.constraints.size());
  values << evaluation.metrics, evaluation.constraints;
  return values;
}

TEST(BenchmarkProblemsTest, GradientsAgreeWithDifferences) {
  for (const BenchmarkProblem& problem : AllProblems()) {
    Random random(2);
    Eigen::VectorXd u(problem.space.size());
    for (double& value : u) value = 0.1 + 0.8 * random.Uniform();
    // Between the steps: where two whole numbers are the same, the larger of them has a kink.
    Eigen::VectorXd x =
        problem.space.lower + u.cwiseProduct(problem.space.upper - problem.space.lower);
    for (const DiscreteParameter& choice : problem.choices) {
      x[choice.parameter] = problem.space.FromUnit(u)[choice.parameter];
    }
    const Evaluation exact = problem.evaluate(x, true);
    EXPECT_EQ(Values(exact), Values(problem.evaluate(x, false))) << problem.name;
    EXPECT_EQ(exact.metrics.size(), problem.metric_count);
    EXPECT_EQ(exact.constraints.size(), problem.constraint_count);
    Eigen::MatrixXd jacobian(problem.metric_count + problem.constraint_count, x.size());
    jacobian.topRows(problem.metric_count) = exact.jacobian;
    if (problem.constraint_count > 0) {
      jacobian.bottomRows(problem.constraint_count) = exact.constraint_jacobian;
    }
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (std::ranges::find(problem.choices, i, &DiscreteParameter::parameter) !=
          problem.choices.end()) {
        continue;
      }
      Eigen::VectorXd up = x, down = x;
      up[i] += 1e-6;
      down[i] -= 1e-6;
      const Eigen::VectorXd slope =
          (Values(problem.evaluate(up, false)) - Values(problem.evaluate(down, false))) / 2e-6;
      const double size = std::max(1.0, jacobian.col(i).norm());
      EXPECT_LT((slope - jacobian.col(i)).norm() / size, 1e-5) << problem.name << " " << i;
    }
  }
}

// The hypervolume of designs whose distance parameters are at their best, `steps` along each
// position parameter.
double HypervolumeOfOptima(const BenchmarkProblem& problem, Eigen::Index positions, double best,
                           int steps) {
  std::vector<Eigen::VectorXd> points;
  Eigen::VectorXd x = Eigen::VectorXd::Constant(problem.space.size(), best);
  for (int i = 0; i <= steps; ++i) {
    x[0] = static_cast<double>(i) / steps;
    for (int j = 0; j <= (positions == 2 ? steps : 0); ++j) {
      if (positions == 2) x[1] = static_cast<double>(j) / steps;
      points.push_back(problem.evaluate(x, false).metrics);
    }
  }
  return Hypervolume(points, problem.reference);
}

TEST(BenchmarkProblemsTest, TrueHypervolumesAreThoseOfTheirOptima) {
  for (const char* name : {"ZDT1", "ZDT2", "ZDT3", "ZDT4", "ZDT6"}) {
    const BenchmarkProblem problem = *MakeBenchmarkProblem(name, 4);
    const double sampled = HypervolumeOfOptima(problem, 1, 0, 5000);
    EXPECT_NEAR(sampled, problem.hypervolume, 1e-3) << name;
    EXPECT_LE(sampled, problem.hypervolume * (1 + 1e-6)) << name;
  }
  for (const char* name : {"DTLZ1", "DTLZ2", "DTLZ3", "DTLZ5", "DTLZ6", "DTLZ7"}) {
    const BenchmarkProblem problem = *MakeBenchmarkProblem(name, 5);
    const double best = name == std::string("DTLZ6") || name == std::string("DTLZ7") ? 0 : 0.5;
    const double sampled = HypervolumeOfOptima(problem, 2, best, 80);
    EXPECT_NEAR(sampled, problem.hypervolume, 0.025 * problem.hypervolume) << name;
    EXPECT_LE(sampled, problem.hypervolume * (1 + 1e-6)) << name;
  }
  EXPECT_EQ(MakeBenchmarkProblem("DTLZ4", 5)->hypervolume,
            MakeBenchmarkProblem("DTLZ2", 5)->hypervolume);
}

// The parameters that are best beside a first one, and what the front is there.
TEST(BenchmarkProblemsTest, WindingProblemsHaveTheirFrontsWhereTheyWind) {
  constexpr int kSize = 7;
  const auto metrics = [](const char* name, const Eigen::VectorXd& x) {
    return MakeBenchmarkProblem(name, kSize)->evaluate(x, false).metrics;
  };
  for (const double first : {0.1, 0.4, 0.9}) {
    Eigen::VectorXd x(kSize);
    x[0] = first;
    for (int j = 2; j <= kSize; ++j) {
      x[j - 1] = std::sin(6 * std::numbers::pi * first + j * std::numbers::pi / kSize);
    }
    EXPECT_NEAR(metrics("UF1", x)[0], first, 1e-12);
    EXPECT_NEAR(metrics("UF1", x)[1], 1 - std::sqrt(first), 1e-12);
    EXPECT_NEAR(metrics("UF7", x).sum(), 1, 1e-12);
    x[3] += 0.1;  // parameter 4 adds to the second metric: 2 / 3 of its square
    EXPECT_NEAR(metrics("UF1", x)[1], 1 - std::sqrt(first) + 2.0 / 3 * 0.01, 1e-12);
  }
  Eigen::VectorXd z(kSize);
  for (int i = 0; i < kSize; ++i) z[i] = 0.35 * 2 * (i + 1);
  EXPECT_NEAR(metrics("WFG4", z)[0], 0, 1e-12);
  EXPECT_NEAR(metrics("WFG4", z)[1], 4, 1e-12);
  z[0] = 0;
  const Eigen::VectorXd on = metrics("WFG4", z);
  EXPECT_NEAR(std::hypot(on[0] / 2, on[1] / 4), 1, 1e-12);
  EXPECT_GT(on[0], 0.1);
  z[5] = 0;
  const Eigen::VectorXd off = metrics("WFG4", z);
  EXPECT_GT(std::hypot(off[0] / 2, off[1] / 4), 1.01);
}

TEST(BenchmarkProblemsTest, VariantsKeepTheFrontAndMoveTheOptima) {
  for (const std::string& name : BenchmarkNames()) {
    if (!HasVariants(name)) continue;
    const BenchmarkProblem plain = *MakeBenchmarkProblem(name, 6);
    const BenchmarkProblem rotated = *MakeBenchmarkProblem(name, 6, {false, true, 5});
    const BenchmarkProblem both = *MakeBenchmarkProblem(name, 6, {true, true, 5});
    EXPECT_EQ(rotated.hypervolume, plain.hypervolume);
    EXPECT_EQ(both.name, "rotated shifted " + name);
    // A rotation about the published optimum leaves that where it is.
    const bool middle = name.starts_with("DTLZ") && name < "DTLZ6";
    Eigen::VectorXd x = Eigen::VectorXd::Constant(6, middle ? 0.5 : 0.0);
    x.head(2) << 0.3, name.starts_with("ZDT") ? 0 : 0.6;
    const Eigen::VectorXd optimum = plain.evaluate(x, false).metrics;
    EXPECT_LT((rotated.evaluate(x, false).metrics - optimum).norm(), 1e-9) << name;
    // It is no optimum of the shifted one, nor is any bound.
    EXPECT_GT((both.evaluate(x, false).metrics - optimum).norm(), 1e-3) << name;
    x.tail(4) = both.space.lower.tail(4);
    EXPECT_GT((both.evaluate(x, false).metrics - optimum).norm(), 1e-3) << name;
    // Another instance is another problem.
    const BenchmarkProblem other = *MakeBenchmarkProblem(name, 6, {true, true, 6});
    EXPECT_NE(other.evaluate(x, false).metrics, both.evaluate(x, false).metrics) << name;
  }
}

// Where metrics count the squares of the distances, a rotation changes nothing.
TEST(BenchmarkProblemsTest, RotationsKeepLengths) {
  Random random(4);
  Eigen::VectorXd x(8);
  for (double& value : x) value = random.Uniform();
  EXPECT_LT((MakeBenchmarkProblem("DTLZ2", 8)->evaluate(x, false).metrics -
             MakeBenchmarkProblem("DTLZ2", 8, {false, true, 2})->evaluate(x, false).metrics)
                .norm(),
            1e-12);
}

TEST(BenchmarkProblemsTest, HaveTheirPublishedOptima) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(7);
  x[0] = 0.25;
  EXPECT_NEAR(MakeBenchmarkProblem("ZDT1", 7)->evaluate(x, false).metrics[1], 0.5, 1e-12);
  EXPECT_NEAR(MakeBenchmarkProblem("zdt2", 7)->evaluate(x, false).metrics[1], 0.9375, 1e-12);
  EXPECT_NEAR(MakeBenchmarkProblem("ZDT4", 7)->evaluate(x, false).metrics[1], 0.5, 1e-12);
  x.setConstant(0.5);
  EXPECT_NEAR(MakeBenchmarkProblem("DTLZ1", 7)->evaluate(x, false).metrics.sum(), 0.5, 1e-12);
  EXPECT_NEAR(MakeBenchmarkProblem("DTLZ2", 7)->evaluate(x, false).metrics.norm(), 1, 1e-12);
  EXPECT_NEAR(MakeBenchmarkProblem("DTLZ3", 7)->evaluate(x, false).metrics.norm(), 1, 1e-12);
  x = Eigen::VectorXd::Zero(3);
  EXPECT_NEAR(MakeBenchmarkProblem("Kursawe", 3)->evaluate(x, false).metrics[0], -20, 1e-12);
}

// Random optima, and random designs, are beyond the true front; the simplex and the sphere hold the
// optima of any number of metrics.
TEST(BenchmarkProblemsTest, ManyMetricsHaveTheirPublishedOptima) {
  Random random(12);
  for (const int d : {2, 4, 5, 6}) {
    for (const char* name : {"DTLZ1", "DTLZ2", "DTLZ3", "DTLZ4"}) {
      const int dimensions = PublishedDimensions(name, d);
      const BenchmarkProblem problem = *MakeBenchmarkProblem(name, dimensions, {.metrics = d});
      ASSERT_EQ(problem.metric_count, d);
      std::vector<Eigen::VectorXd> optima;
      for (int i = 0; i < 200; ++i) {
        Eigen::VectorXd x = Eigen::VectorXd::Constant(dimensions, 0.5);
        for (double& value : x.head(d - 1)) value = random.Uniform();
        optima.push_back(problem.evaluate(x, false).metrics);
        const double size = name[4] == '1' ? 2 * optima.back().sum() : optima.back().norm();
        EXPECT_NEAR(size, 1, 1e-12) << name;
      }
      const double found = Hypervolume(optima, problem.reference);
      EXPECT_LT(found, problem.hypervolume) << name << " " << d;
      const double least = name[4] == '4' ? 0 : 0.6;  // uniform parameters gather in its corners
      EXPECT_GT(found, least * problem.hypervolume) << name << " " << d;
    }
  }
}

TEST(BenchmarkProblemsTest, TrueHypervolumeOfDisconnectedFrontsOfFourMetrics) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("DTLZ7", 5, {.metrics = 4});
  constexpr int kSteps = 40;
  std::vector<Eigen::VectorXd> optima;
  for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(5);
    x.head(3) << i % kSteps, i / kSteps % kSteps, i / kSteps / kSteps;
    x.head(3) *= 0.86 / (kSteps - 1);  // the front ends there
    optima.push_back(problem.evaluate(x, false).metrics);
  }
  const double sampled = SampledHypervolume(optima, problem.reference, 1 << 12);
  EXPECT_NEAR(sampled, problem.hypervolume, 0.02 * problem.hypervolume);
}

TEST(BenchmarkProblemsTest, ConstraintsHoldThePublishedOptima) {
  const auto at = [](const char* name, const Eigen::VectorXd& x) {
    return MakeBenchmarkProblem(name, static_cast<int>(x.size()))->evaluate(x, false);
  };
  EXPECT_EQ(at("BNH", Eigen::Vector2d(5, 3)).metrics, Eigen::Vector2d(136, 4));
  EXPECT_EQ(at("BNH", Eigen::Vector2d(0, 0)).constraints[0], 0);
  const Evaluation srn = at("SRN", Eigen::Vector2d(-2.5, 2.5));
  EXPECT_EQ(srn.metrics, Eigen::Vector2d(24.5, -24.75));
  EXPECT_NEAR(srn.constraints[1], 0, 1e-12);
  EXPECT_NEAR(at("TNK", Eigen::Vector2d(std::sqrt(1.1), 0)).constraints[0], 0, 1e-12);
  Eigen::VectorXd x(6);
  x << 5, 1, 5, 0, 5, 0;
  const Evaluation osy = at("OSY", x);
  EXPECT_EQ(osy.metrics, Eigen::Vector2d(-274, 76));
  EXPECT_LE(osy.constraints.maxCoeff(), 0);
}

// Of all designs on a grid.
TEST(BenchmarkProblemsTest, TrueHypervolumesUnderConstraintsAreThoseOfAGrid) {
  constexpr int kSteps = 700;
  for (const char* name : {"BNH", "SRN", "TNK"}) {
    const BenchmarkProblem problem = *MakeBenchmarkProblem(name, 2);
    std::vector<Eigen::VectorXd> points;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps; ++j) {
        const Evaluation found =
            problem.evaluate(problem.space.FromUnit(Eigen::Vector2d(i, j) / kSteps), false);
        if (found.constraints.maxCoeff() <= 0) points.push_back(found.metrics);
      }
    }
    const double sampled = Hypervolume(points, problem.reference);
    EXPECT_LE(sampled, problem.hypervolume * (1 + 1e-6)) << name;
    EXPECT_GT(sampled, problem.hypervolume * 0.985) << name;
  }
}

TEST(BenchmarkProblemsTest, RefusesWhatDoesNotExist) {
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("ZDT5", 10).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("ZDT1", 1).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("Kursawe", 4).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("ZDT1", -3).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("DTLZ8", 12).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("", 12).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("Kursawe", 3, {true, false}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("OSY", 5).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("ZDT1", 5, {.metrics = 3}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("Fourier", 5, {.metrics = 7}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("DTLZ2", 5, {.metrics = 1}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("DTLZ2", 4, {.metrics = 5}).status()));
  EXPECT_EQ(PublishedDimensions("Rosenbrock"), 0);
}

}  // namespace
}  // namespace mortise::pareto
