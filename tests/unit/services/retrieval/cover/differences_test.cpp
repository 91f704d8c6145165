// Differences in the middle of the feasible set, at its edge, and where there is no room.
#include "services/retrieval/cover/differences.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

// sin q over [0, 1], refused outside.
FunctionManifold Sine() {
  return FunctionManifold(testing::Over(VectorXd::Zero(1), VectorXd::Ones(1), 1,
                                        [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
                                          if (q[0] < 0 || q[0] > 1) {
                                            return absl::InvalidArgumentError("outside");
                                          }
                                          return VectorXd(VectorXd::Constant(1, std::sin(q[0])));
                                        }));
}

Derivatives At(const FunctionManifold& manifold, double q, double step) {
  ParallelEvaluator evaluator(manifold, 1);
  const VectorXd point = VectorXd::Constant(1, q);
  return *CentralDifferences(evaluator, point, *manifold.Evaluate(point),
                             VectorXd::Constant(1, step));
}

TEST(Differences, AreExactForParabolasUpToTheEdge) {
  const FunctionManifold manifold(testing::Paraboloid());
  ParallelEvaluator evaluator(manifold, 2);
  for (const Eigen::Vector2d& q : {Eigen::Vector2d(0.3, 0.2), Eigen::Vector2d(1, -1)}) {
    ASSERT_OK_AND_ASSIGN(
        const Derivatives derivatives,
        CentralDifferences(evaluator, q, *manifold.Evaluate(q), Eigen::Vector2d(0.01, 0.01)));
    EXPECT_NEAR(derivatives.first(2, 0), 2 * q[0], 1e-9);
    EXPECT_NEAR(derivatives.first(2, 1), 2 * q[1], 1e-9);
    EXPECT_NEAR(derivatives.second(2, 0), 2, 1e-8);
    EXPECT_NEAR(derivatives.second(0, 0), 0, 1e-8);
  }
}

TEST(Differences, StayWithinTheFeasibleSet) {
  const FunctionManifold manifold = Sine();
  for (const double q : {0.0, 0.004, 0.5, 0.999, 1.0}) {
    const Derivatives derivatives = At(manifold, q, 0.01);
    EXPECT_NEAR(derivatives.first(0, 0), std::cos(q), 1e-4) << q;
    EXPECT_NEAR(derivatives.second(0, 0), -std::sin(q), 0.02) << q;
  }
}

TEST(Differences, OfAParameterWithoutExtentAreNothing) {
  const Derivatives derivatives = At(Sine(), 0.5, 0);
  EXPECT_EQ(derivatives.first(0, 0), 0);
  EXPECT_EQ(derivatives.second(0, 0), 0);
}

TEST(Differences, TakeLongerStepsWhereThereIsNoise) {
  const VectorXd extents = VectorXd::Constant(1, 2);
  EXPECT_DOUBLE_EQ(DifferenceSteps(extents, 0)[0], 2e-3);
  EXPECT_DOUBLE_EQ(DifferenceSteps(extents, 1e-8)[0], 2e-2);
  EXPECT_DOUBLE_EQ(DifferenceSteps(extents, 1)[0], 2.0 / 16);
}

TEST(Differences, FailWhereANeighbourCannotBeEvaluated) {
  FunctionManifold manifold(testing::Over(VectorXd::Zero(1), VectorXd::Ones(1), 1,
                                          [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
                                            if (q[0] > 0.5) {
                                              return absl::InternalError("the shelf meets the top");
                                            }
                                            return VectorXd(q);
                                          }));
  ParallelEvaluator evaluator(manifold, 1);
  const VectorXd q = VectorXd::Constant(1, 0.5);
  EXPECT_FALSE(CentralDifferences(evaluator, q, q, VectorXd::Constant(1, 0.01)).ok());
}

}  // namespace
}  // namespace mortise::retrieval
