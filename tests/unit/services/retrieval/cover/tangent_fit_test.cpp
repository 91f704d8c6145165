// Measured radii: by curvature, by boundary, by what cannot be evaluated.
#include "services/retrieval/cover/tangent_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

Primitive TangentAt(const FunctionManifold& manifold, const VectorXd& q, double delta,
                    Eigen::Index axes) {
  const VectorXd value = *manifold.Evaluate(q);
  const TangentFrame frame(manifold.constraints(), q, *manifold.DerivativesAt(q),
                           *ExtentsOf(manifold.constraints()), delta);
  ParallelEvaluator evaluator(manifold, 1);
  return *FitTangent(evaluator, frame, axes,
                     {.parameters = q,
                      .value = value,
                      .structure = manifold.Structure(q),
                      .delta = delta,
                      .seed = 1});
}

TEST(TangentFit, OnACircleRadiusFollowsCurvature) {
  const FunctionManifold manifold(testing::Circle());
  const Primitive tangent = TangentAt(manifold, VectorXd::Constant(1, 3), 0.01, 1);
  // At the end the circle is less than δ away, and not much less.
  const double left = std::hypot(1, tangent.radii[0]) - 1;
  EXPECT_LE(left, 0.01);
  EXPECT_GE(left, 0.006);
}

TEST(TangentFit, RadiusOnALineEndsNineTenthsOfDeltaBeyondItsEnd) {
  const FunctionManifold manifold(testing::Line(1));
  const VectorXd q = VectorXd::Constant(1, 0.5);
  const Primitive tangent = TangentAt(manifold, q, 0.05, 1);
  EXPECT_NEAR(tangent.radii[0], manifold.Evaluate(q)->norm() + 0.9 * 0.05, 1e-6);
}

TEST(TangentFit, EndsBeforeWhatCannotBeEvaluated) {
  ManifoldFunctions functions = testing::Line(1);
  const auto line = functions.evaluate;
  functions.evaluate = [line](const VectorXd& q) -> absl::StatusOr<VectorXd> {
    if (q[0] < 0.3) return absl::InternalError("the shelf meets the top");
    return line(q);
  };
  const FunctionManifold manifold(functions);
  const VectorXd q = VectorXd::Constant(1, 0.6);
  const Primitive tangent = TangentAt(manifold, q, 0.01, 1);
  const double room = (*manifold.Evaluate(q) - *line(VectorXd::Constant(1, 0.3))).norm();
  EXPECT_LE(tangent.radii[0], room + 0.01);
  EXPECT_GE(tangent.radii[0], 0.01);
}

TEST(TangentFit, EndsBeforeAnotherStructure) {
  ManifoldFunctions functions = testing::Line(1);
  functions.structure = [](const VectorXd& q) { return q[0] < 0.5 ? 3 : 4; };
  const FunctionManifold manifold(functions);
  const VectorXd q = VectorXd::Constant(1, 0.8);
  const Primitive tangent = TangentAt(manifold, q, 0.01, 1);
  const double room =
      (*manifold.Evaluate(q) - *manifold.Evaluate(VectorXd::Constant(1, 0.5))).norm();
  EXPECT_LE(tangent.radii[0], room + 0.01);
  EXPECT_EQ(tangent.structure, 4);
}

TEST(TangentFit, OnACylinderRadiiDifferAndDescend) {
  const FunctionManifold manifold(testing::Cylinder());
  const Primitive tangent = TangentAt(manifold, Vector2d(1.5, 2), 0.01, 2);
  EXPECT_NEAR(tangent.radii[0], 2, 0.1);
  EXPECT_NEAR(tangent.radii[1], std::sqrt(2 * 0.009), 0.03);
  Primitive axis = tangent;
  KeepAxes(1, &axis);
  EXPECT_EQ(Cost(axis), 2);
  EXPECT_EQ(axis.axes.col(0), tangent.axes.col(0));
  EXPECT_EQ(axis.radii[0], tangent.radii[0]);
}

TEST(TangentFit, NeverFallsBelowABallOfDelta) {
  // So curved that nothing but the ball is tight.
  const FunctionManifold manifold(testing::Over(
      Vector2d(0, 0), Vector2d(1, 1), 3, [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
        return VectorXd(Eigen::Vector3d(q[0], q[1], std::sin(60 * q[0]) * std::sin(60 * q[1])));
      }));
  const Primitive tangent = TangentAt(manifold, Vector2d(0.513, 0.522), 0.2, 2);
  EXPECT_GE(tangent.radii.minCoeff(), 0.2 - 1e-12);
}

}  // namespace
}  // namespace mortise::retrieval
