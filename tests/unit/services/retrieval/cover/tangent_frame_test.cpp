// Rank, axes and boundaries of tangent spaces.
#include "services/retrieval/cover/tangent_frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

TangentFrame FrameAt(const FunctionManifold& manifold, const VectorXd& q, double delta) {
  return TangentFrame(manifold.constraints(), q, *manifold.DerivativesAt(q),
                      *ExtentsOf(manifold.constraints()), delta);
}

TEST(TangentFrame, HasTheRankOfTheManifold) {
  const FunctionManifold sheet(testing::Sheet()), proportions(testing::Proportions());
  EXPECT_EQ(FrameAt(sheet, Vector2d(0.5, 0.5), 0.1).rank(), 2);
  EXPECT_EQ(FrameAt(proportions, Eigen::Vector3d(2, 1.5, 2.5), 0.1).rank(), 2);
}

TEST(TangentFrame, LeavesOutWhatMovesNothingForThisDelta) {
  const FunctionManifold manifold(testing::Over(Vector2d(0, 0), Vector2d(1, 1), 2,
                                                [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
                                                  return VectorXd(Vector2d(q[0], 0.005 * q[1]));
                                                }));
  EXPECT_EQ(FrameAt(manifold, Vector2d(0.5, 0.5), 0.1).rank(), 1);
  EXPECT_EQ(FrameAt(manifold, Vector2d(0.5, 0.5), 0.01).rank(), 2);
}

TEST(TangentFrame, LeavesOutWhatIsNoMoreThanNoise) {
  const FunctionManifold manifold(testing::Over(Vector2d(0, 0), Vector2d(1, 1), 2,
                                                [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
                                                  return VectorXd(Vector2d(q[0], 0.05 * q[1]));
                                                }));
  const Vector2d q(0.5, 0.5);
  const Derivatives derivatives = *manifold.DerivativesAt(q);
  const Vector2d extents(1, 1);
  EXPECT_EQ(TangentFrame(manifold.constraints(), q, derivatives, extents, 0.01, 0.01).rank(), 2);
  EXPECT_EQ(TangentFrame(manifold.constraints(), q, derivatives, extents, 0.01, 0.03).rank(), 1);
}

TEST(TangentFrame, AxesAreOrthonormalAndTangent) {
  const FunctionManifold manifold(testing::SpherePatch());
  const Vector2d q(0.7, 0.3);
  const TangentFrame frame = FrameAt(manifold, q, 0.01);
  ASSERT_EQ(frame.rank(), 2);
  EXPECT_TRUE((frame.basis().transpose() * frame.basis()).isIdentity(1e-9));
  EXPECT_LT((frame.basis().transpose() * *manifold.Evaluate(q)).norm(), 1e-6);
}

TEST(TangentFrame, PredictsTheRadiusOfACircle) {
  const FunctionManifold manifold(testing::Circle());
  const TangentFrame frame = FrameAt(manifold, VectorXd::Constant(1, 3), 0.02);
  EXPECT_NEAR(frame.curvature_radii()[0], std::sqrt(2 * 0.02), 1e-4);
}

TEST(TangentFrame, FirstAxisIsTheFlatOneOfACylinder) {
  const FunctionManifold manifold(testing::Cylinder());
  const TangentFrame frame = FrameAt(manifold, Vector2d(1.5, 2), 0.01);
  EXPECT_NEAR(std::abs(frame.basis()(2, 0)), 1, 1e-6);
  EXPECT_NEAR(frame.predicted_radii()[0], 2.01, 1e-6);
}

TEST(TangentFrame, TurnsTowardsTheNearestBoundary) {
  // The strip |q0 + q1| <= 0.2 of a flat square: axes lie across it and along it.
  ManifoldFunctions functions =
      testing::Over(Vector2d(-1, -1), Vector2d(1, 1), 2,
                    [](const VectorXd& q) -> absl::StatusOr<VectorXd> { return VectorXd(q); });
  functions.cuts.normals.resize(2, 2);
  functions.cuts.normals << 1, 1, -1, -1;
  functions.cuts.bounds = Vector2d(0.2, 0.2);
  const FunctionManifold manifold(functions);
  const TangentFrame frame = FrameAt(manifold, Vector2d(0, 0), 0.01);
  ASSERT_EQ(frame.rank(), 2);
  EXPECT_NEAR(std::abs(frame.basis().col(0).dot(Vector2d(1, -1).normalized())), 1, 1e-6);
  EXPECT_NEAR(frame.predicted_radii()[1], 0.01 + 0.2 / std::sqrt(2), 1e-6);
}

TEST(TangentFrame, WayEndsAtTheBoundary) {
  const FunctionManifold manifold(testing::Sheet());
  const Vector2d q(0.25, 0.5);
  const TangentFrame frame = FrameAt(manifold, q, 0.01);
  ASSERT_OK_AND_ASSIGN(const Way way, frame.WayAlong(Vector2d(1, 0)));
  const double left =
      (manifold.constraints().bounds - manifold.constraints().normals * (q + way.change))
          .minCoeff();
  EXPECT_NEAR(left, 0, 1e-9);
  EXPECT_NEAR(way.length, way.change.norm(), 1e-6);  // the sheet keeps lengths
}

TEST(TangentFrame, WayUsesWhatMovesNothingToGoFurther) {
  // Only the ratio counts. From (2.9, 2.9) the ratio can fall to 1/3 by the second parameter alone,
  // though the least change soon meets the first one's bound.
  const FunctionManifold manifold(testing::Over(
      Vector2d(1, 1), Vector2d(3, 3), 1, [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
        return VectorXd(VectorXd::Constant(1, q[1] - q[0]));
      }));
  const Vector2d q(2.9, 2.9);
  const TangentFrame frame = FrameAt(manifold, q, 0.01);
  ASSERT_EQ(frame.rank(), 1);
  for (const double sign : {1.0, -1.0}) {
    ASSERT_OK_AND_ASSIGN(const Way way, frame.WayAlong(VectorXd::Constant(1, sign)));
    EXPECT_NEAR(way.length, 2, 1e-6);
    EXPECT_NEAR(std::abs(way.change[1] - way.change[0]), 2, 1e-6);
  }
}

TEST(TangentFrame, AxesPayByTheirProduct) {
  EXPECT_EQ(AxesThatPay(VectorXd(0), 1), 0);
  EXPECT_EQ(AxesThatPay(VectorXd::Constant(1, 1.9), 1), 0);
  EXPECT_EQ(AxesThatPay(VectorXd::Constant(1, 2.1), 1), 1);
  EXPECT_EQ(AxesThatPay(Vector2d(3, 1.2), 1), 1);
  EXPECT_EQ(AxesThatPay(Vector2d(3, 1.6), 1), 2);
  EXPECT_EQ(AxesThatPay(Vector2d(1.8, 1.8), 1), 2);
  EXPECT_EQ(AxesThatPay(Vector2d(18, 18), 10), 2);
}

}  // namespace
}  // namespace mortise::retrieval
