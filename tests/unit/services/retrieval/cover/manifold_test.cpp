// Feasible sets and manifolds given by functions.
#include "services/retrieval/cover/manifold.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <vector>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

LinearConstraints UnitTriangle() {
  LinearConstraints triangle;
  triangle.normals.resize(3, 2);
  triangle.normals << -1, 0, 0, -1, 1, 1;
  triangle.bounds = Eigen::Vector3d(0, 0, 1);
  return triangle;
}

TEST(Manifold, RoomEndsAtTheFirstConstraint) {
  const LinearConstraints box = BoxConstraints(Vector2d(0, 0), Vector2d(2, 4));
  EXPECT_DOUBLE_EQ(RoomAlong(box, Vector2d(1, 1), Vector2d(1, 1)), 1);
  EXPECT_DOUBLE_EQ(RoomAlong(box, Vector2d(1, 1), Vector2d(0, -2)), 0.5);
  EXPECT_DOUBLE_EQ(RoomAlong(box, Vector2d(2, 1), Vector2d(1, 0)), 0);
  EXPECT_EQ(RoomAlong(box, Vector2d(1, 1), Vector2d(0, 0)),
            std::numeric_limits<double>::infinity());
}

TEST(Manifold, ExtentsAreThoseOfTheFeasibleSet) {
  ASSERT_OK_AND_ASSIGN(const VectorXd extents, ExtentsOf(UnitTriangle()));
  EXPECT_NEAR(extents[0], 1, 1e-9);
  EXPECT_NEAR(extents[1], 1, 1e-9);
}

// Nothing lies between whole numbers: samples have none, and what is asked between them is what is
// at the nearest.
TEST(Manifold, WholeNumbersAreRounded) {
  ManifoldFunctions functions = testing::Paraboloid();
  functions.lower = Vector2d(-1, -1);
  functions.upper = Vector2d(1, 2);
  functions.whole = {false, true};
  functions.structure = [](const VectorXd& q) { return static_cast<int>(q[1]) + 2; };
  const FunctionManifold manifold(functions);
  ASSERT_OK_AND_ASSIGN(const std::vector<VectorXd> samples, manifold.Sample(200, 3));
  std::set<double> whole;
  for (const VectorXd& q : samples) {
    whole.insert(q[1]);
    ASSERT_OK_AND_ASSIGN(const VectorXd at, manifold.Evaluate(q));
    ASSERT_OK_AND_ASSIGN(const VectorXd beside, manifold.Evaluate(q + Vector2d(0, 0.4)));
    EXPECT_EQ(at, beside);
    EXPECT_EQ(manifold.Structure(q + Vector2d(0, -0.4)), static_cast<int>(q[1]) + 2);
  }
  EXPECT_EQ(whole, (std::set<double>{-1, 0, 1, 2}));
}

TEST(Manifold, UnboundedSetsAreRefused) {
  LinearConstraints wedge = UnitTriangle();
  wedge.bounds.conservativeResize(2);
  wedge.normals.conservativeResize(2, Eigen::NoChange);
  EXPECT_EQ(ExtentsOf(wedge).status().code(), absl::StatusCode::kFailedPrecondition);
}

TEST(Manifold, SamplesKeepCutsAndRepeatForASeed) {
  ManifoldFunctions functions = testing::Paraboloid();
  functions.cuts.normals = Eigen::RowVector2d(1, 1);
  functions.cuts.bounds = VectorXd::Zero(1);
  const FunctionManifold manifold(functions);
  ASSERT_OK_AND_ASSIGN(const auto samples, manifold.Sample(100, 4));
  ASSERT_OK_AND_ASSIGN(const auto again, manifold.Sample(100, 4));
  ASSERT_EQ(samples.size(), 100u);
  EXPECT_EQ(samples, again);
  for (const VectorXd& q : samples) EXPECT_LE(q.sum(), 0);
}

TEST(Manifold, CutsThatLeaveNothingAreRefused) {
  ManifoldFunctions functions = testing::Paraboloid();
  functions.cuts.normals = Eigen::RowVector2d(1, 1);
  functions.cuts.bounds = VectorXd::Constant(1, -3);
  EXPECT_EQ(FunctionManifold(functions).Sample(1, 4).status().code(),
            absl::StatusCode::kFailedPrecondition);
}

TEST(Manifold, DerivativesAreDifferencesUnlessGiven) {
  ManifoldFunctions functions = testing::Paraboloid();
  ASSERT_OK_AND_ASSIGN(const Derivatives differences,
                       FunctionManifold(functions).DerivativesAt(Vector2d(0.5, -0.25)));
  EXPECT_NEAR(differences.first(2, 0), 1, 1e-8);
  EXPECT_NEAR(differences.first(2, 1), -0.5, 1e-8);
  EXPECT_NEAR(differences.second(2, 0), 2, 1e-6);
  functions.derivatives = [](const VectorXd&) -> absl::StatusOr<Derivatives> {
    return Derivatives{Eigen::MatrixXd::Constant(3, 2, 7), Eigen::MatrixXd::Zero(3, 2)};
  };
  ASSERT_OK_AND_ASSIGN(const Derivatives given,
                       FunctionManifold(functions).DerivativesAt(Vector2d(0.5, -0.25)));
  EXPECT_EQ(given.first(0, 0), 7);
}

}  // namespace
}  // namespace mortise::retrieval
