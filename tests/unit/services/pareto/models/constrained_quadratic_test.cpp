// Steps within constraints: against answers known in closed form, and their promises on random
// ones.
#include "services/pareto/models/constrained_quadratic.h"

#include <gtest/gtest.h>

#include "common/base/random.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd RandomSymmetric(Eigen::Index n, Random& random) {
  MatrixXd A(n, n);
  for (double& value : A.reshaped()) value = 2 * random.Uniform() - 1;
  return 0.5 * (A + A.transpose());
}

TEST(ConstrainedQuadraticTest, ProjectsOntoALineAndACircle) {
  const VectorXd lower = VectorXd::Constant(2, -1), upper = VectorXd::Constant(2, 3);
  // |p - (2, 1)|^2 / 2.
  const QuadraticFunction objective{2.5, Eigen::Vector2d(-2, -1), MatrixXd::Identity(2, 2)};
  const QuadraticFunction line{-1, Eigen::Vector2d(1, 1), MatrixXd::Zero(2, 2)};
  const VectorXd on_line = MinimizeWithin(objective, {line}, lower, upper);
  EXPECT_LT((on_line - Eigen::Vector2d(1, 0)).norm(), 1e-6);
  const QuadraticFunction circle{-1, Eigen::Vector2d(0, 0), 2 * MatrixXd::Identity(2, 2)};
  const VectorXd on_circle = MinimizeWithin(objective, {circle}, lower, upper);
  EXPECT_LT((on_circle - Eigen::Vector2d(2, 1).normalized()).norm(), 1e-5);
}

TEST(ConstrainedQuadraticTest, KeepsToBoundsAndConstraintsAndNeverGetsWorse) {
  Random random(3);
  int moved = 0;
  for (int round = 0; round < 200; ++round) {
    const Eigen::Index n = 1 + static_cast<Eigen::Index>(random.Index(10));
    const VectorXd lower = VectorXd::Constant(n, -0.3), upper = VectorXd::Constant(n, 0.2);
    const QuadraticFunction objective{1, random.UnitVector(n), RandomSymmetric(n, random)};
    std::vector<QuadraticFunction> constraints;
    for (std::size_t j = random.Index(4); j > 0; --j) {
      constraints.push_back(
          {-0.1 * random.Uniform(), random.UnitVector(n), RandomSymmetric(n, random)});
    }
    const VectorXd p = MinimizeWithin(objective, constraints, lower, upper);
    EXPECT_TRUE((p.array() >= lower.array()).all() && (p.array() <= upper.array()).all());
    EXPECT_EQ(Violation(constraints, p), 0) << round;
    EXPECT_LE(objective(p), objective.value);
    moved += objective(p) < objective.value - 1e-3 ? 1 : 0;
    // It is at least locally a minimum: no step nearby that keeps to all is much better.
    for (int trial = 0; trial < 50; ++trial) {
      const VectorXd near = (p + 1e-3 * random.UnitVector(n)).cwiseMax(lower).cwiseMin(upper);
      if (Violation(constraints, near) == 0) {
        EXPECT_GT(objective(near), objective(p) - 2e-4) << round;
      }
    }
  }
  EXPECT_GT(moved, 150);
}

TEST(ConstrainedQuadraticTest, DoesNotWorsenWhatIsViolatedAlready) {
  const VectorXd lower = VectorXd::Constant(1, -1), upper = VectorXd::Constant(1, 1);
  const QuadraticFunction objective{0, VectorXd::Constant(1, -1), MatrixXd::Zero(1, 1)};
  const QuadraticFunction constraint{0.5, VectorXd::Constant(1, 1), MatrixXd::Zero(1, 1)};
  EXPECT_NEAR(MinimizeWithin(objective, {constraint}, lower, upper)[0], 0, 1e-9);
}

TEST(ConstrainedQuadraticTest, ReducesViolationsToNothingWhereItCan) {
  const VectorXd lower = VectorXd::Constant(2, -1), upper = VectorXd::Constant(2, 1);
  const QuadraticFunction right{0.5, Eigen::Vector2d(-1, 0), MatrixXd::Zero(2, 2)};  // p0 >= 0.5
  const VectorXd p = ReduceViolation({right}, lower, upper);
  EXPECT_NEAR(p[0], 0.5, 1e-3);
  EXPECT_NEAR(p[1], 0, 1e-6);
  // Contradictory: half way.
  const QuadraticFunction left{0.5, Eigen::Vector2d(1, 0), MatrixXd::Zero(2, 2)};  // p0 <= -0.5
  EXPECT_NEAR(ReduceViolation({right, left}, lower, upper)[0], 0, 1e-3);
  // Out of reach: to the bound.
  const QuadraticFunction far{3, Eigen::Vector2d(-1, 0), MatrixXd::Zero(2, 2)};
  EXPECT_DOUBLE_EQ(ReduceViolation({far}, lower, upper)[0], 1);
}

TEST(ConstrainedQuadraticTest, ReducesRandomViolations) {
  Random random(8);
  for (int round = 0; round < 100; ++round) {
    const Eigen::Index n = 1 + static_cast<Eigen::Index>(random.Index(10));
    const VectorXd lower = VectorXd::Constant(n, -0.4), upper = VectorXd::Constant(n, 0.4);
    std::vector<QuadraticFunction> constraints;
    for (std::size_t j = 1 + random.Index(3); j > 0; --j) {
      constraints.push_back(
          {random.Uniform() - 0.3, random.UnitVector(n), 0.5 * RandomSymmetric(n, random)});
    }
    const double before = Violation(constraints, VectorXd::Zero(n));
    const VectorXd p = ReduceViolation(constraints, lower, upper);
    EXPECT_TRUE((p.array() >= lower.array()).all() && (p.array() <= upper.array()).all());
    EXPECT_LE(Violation(constraints, p), before);
    for (int trial = 0; trial < 20; ++trial) {
      const VectorXd near = (p + 1e-2 * random.UnitVector(n)).cwiseMax(lower).cwiseMin(upper);
      EXPECT_GT(Violation(constraints, near), Violation(constraints, p) - 2e-2) << round;
    }
  }
}

}  // namespace
}  // namespace mortise::pareto
