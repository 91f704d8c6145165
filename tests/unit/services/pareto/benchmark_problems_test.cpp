// The benchmark problems' published optima, and their gradients against differences.
#include "services/pareto/benchmark_problems.h"

#include <gtest/gtest.h>

#include <cmath>

#include "services/pareto/random.h"

namespace mortise::pareto {
namespace {

int DimensionsOf(const std::string& name) { return name == "Kursawe" || name == "Fourier" ? 3 : 7; }

TEST(BenchmarkProblemsTest, GradientsAgreeWithDifferences) {
  for (const std::string& name : BenchmarkNames()) {
    const BenchmarkProblem problem = *MakeBenchmarkProblem(name, DimensionsOf(name));
    Random random(2);
    Eigen::VectorXd u(problem.space.size());
    for (double& value : u) value = 0.1 + 0.8 * random.Uniform();
    const Eigen::VectorXd x = problem.space.FromUnit(u);
    const Evaluation exact = problem.evaluate(x, true);
    EXPECT_EQ(exact.metrics, problem.evaluate(x, false).metrics) << name;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Eigen::VectorXd up = x, down = x;
      up[i] += 1e-6;
      down[i] -= 1e-6;
      const Eigen::VectorXd slope =
          (problem.evaluate(up, false).metrics - problem.evaluate(down, false).metrics) / 2e-6;
      const double size = std::max(1.0, exact.jacobian.col(i).norm());
      EXPECT_LT((slope - exact.jacobian.col(i)).norm() / size, 1e-5) << name << " " << i;
    }
  }
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

TEST(BenchmarkProblemsTest, RefusesWhatDoesNotExist) {
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("ZDT5", 10).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("ZDT1", 1).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("Kursawe", 4).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(MakeBenchmarkProblem("ZDT1", -3).status()));
}

}  // namespace
}  // namespace mortise::pareto
