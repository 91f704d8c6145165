// Steps that are free, bounded, and bounded with something to spare.
#include "services/retrieval/cover/constrained_step.h"

#include <gtest/gtest.h>

#include "tests/support/status_assertions.h"

namespace mortise::retrieval {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

const LinearConstraints kBox = BoxConstraints(Vector2d(0, 0), Vector2d(1, 1));

VectorXd StepFrom(const VectorXd& q, const MatrixXd& jacobian, const VectorXd& move) {
  return *ConstrainedStep(kBox, q, jacobian, Vector2d(1, 1), move);
}

TEST(ConstrainedStep, IsNewtonsWhereNothingBounds) {
  MatrixXd jacobian(3, 2);
  jacobian << 1, 2, 0, 1, 1, 0;
  const Vector2d change(0.2, -0.1);
  EXPECT_LT((StepFrom(Vector2d(0.5, 0.5), jacobian, jacobian * change) - change).norm(), 1e-4);
}

TEST(ConstrainedStep, EndsAtTheNearestPlaceOfABound) {
  const VectorXd step = StepFrom(Vector2d(0.5, 0.5), MatrixXd::Identity(2, 2), Vector2d(2, 0.1));
  EXPECT_NEAR(step[0], 0.5, 1e-5);
  EXPECT_NEAR(step[1], 0.1, 1e-5);
}

TEST(ConstrainedStep, UsesWhatIsLeftToReachTheTarget) {
  // Only the difference counts: the first parameter is at its bound, so the second goes alone.
  const MatrixXd difference = Eigen::RowVector2d(1, -1);
  const VectorXd step = StepFrom(Vector2d(1, 0.9), difference, VectorXd::Constant(1, 0.6));
  EXPECT_NEAR(step[0], 0, 1e-4);
  EXPECT_NEAR(step[1], -0.6, 1e-4);
}

TEST(ConstrainedStep, OfNothingIsNothing) {
  EXPECT_EQ(StepFrom(Vector2d(0.5, 0.5), MatrixXd::Zero(3, 2), VectorXd::Ones(3)).norm(), 0);
}

}  // namespace
}  // namespace mortise::retrieval
