#include "services/pareto/front/front_exploration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/pareto/archive/embedding.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

// F = (t, -(1 - t)^2), the second to be large, of designs (t, 0.3, 5 t); a second piece, on which
// the second parameter is 0.9, from t = 0.5 on.
FrontPoints Parabola(int count = 101) {
  FrontPoints points;
  points.parameters.resize(3, count);
  points.metrics.resize(2, count);
  points.embedding.resize(1, count);
  points.signs = Eigen::Vector2d(1, -1);
  points.ranges = Eigen::Vector3d(1, 1, 10);
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / (count - 1);
    points.parameters.col(i) << t, t < 0.5 ? 0.3 : 0.9, 5 * t;
    points.metrics.col(i) << t, -(1 - t) * (1 - t);
    points.embedding(0, i) = t;
    points.piece.push_back(t < 0.5 ? 0 : 1);
  }
  return points;
}

// The plane f1 + f2 + f3 = 1 with designs (f1, f2).
FrontPoints Plane(int side = 20) {
  FrontPoints points;
  const int count = (side + 1) * (side + 2) / 2;
  points.parameters.resize(2, count);
  points.metrics.resize(3, count);
  points.embedding.resize(2, count);
  points.signs = VectorXd::Ones(3);
  points.ranges = VectorXd::Ones(2);
  int column = 0;
  for (int i = 0; i <= side; ++i) {
    for (int k = 0; i + k <= side; ++k, ++column) {
      const double a = static_cast<double>(i) / side, b = static_cast<double>(k) / side;
      points.parameters.col(column) << a, b;
      points.metrics.col(column) << a, b, 1 - a - b;
      points.embedding.col(column) = Embed(points.metrics.col(column));
      points.piece.push_back(0);
    }
  }
  return points;
}

TEST(FrontExploration, PicksTheNearest) {
  const FrontExploration front(Parabola());
  EXPECT_EQ(*front.AtMetric(0, 0.172), 17);
  EXPECT_EQ(*front.AtMetric(1, 100), 100);
  EXPECT_EQ(*front.AtEmbedding(VectorXd::Constant(1, 0)), 0);
  EXPECT_EQ(*front.AtEmbedding(VectorXd::Constant(1, 0.304)), 30);
  EXPECT_EQ(*front.At(100), 100);
}

TEST(FrontExploration, RefusesBadPositions) {
  const FrontExploration front(Parabola());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(absl::IsInvalidArgument(front.AtEmbedding(VectorXd::Zero(2)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(front.AtEmbedding(VectorXd::Constant(1, 2)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(front.AtEmbedding(VectorXd::Constant(1, nan)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(front.AtMetric(2, 0).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(front.AtMetric(0, nan).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(front.At(101).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(front.At(-1).status()));
  const FrontExploration empty{FrontPoints{}};
  EXPECT_TRUE(absl::IsFailedPrecondition(empty.AtMetric(0, 1).status()));
  EXPECT_TRUE(absl::IsFailedPrecondition(empty.At(0).status()));
  EXPECT_TRUE(empty.Within({}).points.empty());
}

TEST(FrontExploration, TellsWhatImprovingCosts) {
  const FrontExploration front(Parabola());
  const std::vector<Improvement> improvements = front.ImprovementsAt(20);  // t = 0.2
  ASSERT_EQ(improvements.size(), 2u);
  // dF2 / dt = 2 (1 - t) = 1.6.
  const Improvement& lighter = improvements[0];
  EXPECT_EQ(lighter.metric, 0);
  EXPECT_EQ(lighter.metrics[0], -1);
  EXPECT_NEAR(lighter.metrics[1], -1.6, 1e-3);
  EXPECT_NEAR((lighter.parameters - Eigen::Vector3d(-1, 0, -5)).norm(), 0, 1e-3);
  EXPECT_NEAR((lighter.shares - Eigen::Vector3d(0.8, 0, 0.2)).norm(), 0, 1e-9);
  const Improvement& better = improvements[1];
  EXPECT_EQ(better.metrics[1], 1) << "larger is better";
  EXPECT_NEAR(better.metrics[0], 1 / 1.6, 1e-3);
  EXPECT_NEAR(better.parameters[2], 5 / 1.6, 1e-2);
}

TEST(FrontExploration, KeepsToThePieceNextToAJump) {
  const FrontExploration front(Parabola());
  for (const int point : {49, 50}) {
    for (const Improvement& improvement : front.ImprovementsAt(point)) {
      EXPECT_NEAR(improvement.parameters[1], 0, 1e-9) << "the second parameter jumps";
    }
  }
  FrontPoints alone = Parabola();
  alone.piece[30] = 2;
  EXPECT_TRUE(FrontExploration(alone).ImprovementsAt(30).empty());
}

TEST(FrontExploration, FindsTheFastestWayOnAPlane) {
  const FrontExploration front(Plane());
  const int inside = *front.AtEmbedding(Eigen::Vector2d(0.3, 0.4));
  const std::vector<Improvement> improvements = front.ImprovementsAt(inside);
  ASSERT_EQ(improvements.size(), 3u);
  EXPECT_NEAR((improvements[0].metrics - Eigen::Vector3d(-1, 0.5, 0.5)).norm(), 0, 1e-9);
  EXPECT_NEAR((improvements[0].parameters - Eigen::Vector2d(-1, 0.5)).norm(), 0, 1e-9);
  EXPECT_NEAR((improvements[2].metrics - Eigen::Vector3d(0.5, 0.5, -1)).norm(), 0, 1e-9);
  EXPECT_NEAR((improvements[2].shares - Eigen::Vector2d(0.5, 0.5)).norm(), 0, 1e-9);
}

TEST(FrontExploration, WalksUntilNothingImproves) {
  const FrontExploration line(Parabola());
  EXPECT_EQ(line.NeighboursOf(0), std::vector<int>{1});
  EXPECT_EQ(line.NeighboursOf(5), (std::vector<int>{4, 6}));
  EXPECT_EQ(line.Walk(5, 0, 3), (std::vector<int>{4, 3, 2}));
  EXPECT_EQ(line.Walk(98, 1, 10), (std::vector<int>{99, 100})) << "larger is better";
  EXPECT_TRUE(line.Walk(0, 0, 10).empty());

  const FrontExploration plane(Plane());
  const int start = *plane.AtEmbedding(Eigen::Vector2d(0.5, 0.2));
  EXPECT_EQ(plane.NeighboursOf(start).size(), 6u);
  const std::vector<int> path = plane.Walk(start, 0, 100);
  ASSERT_FALSE(path.empty());
  double previous = 0.5;
  for (const int point : path) {
    EXPECT_LT(plane.points().metrics(0, point), previous);
    previous = plane.points().metrics(0, point);
  }
  EXPECT_NEAR(previous, 0, 1e-12);
}

TEST(FrontExploration, TellsWhatRemainsWithinLimits) {
  const FrontExploration front(Parabola());
  const FrontPart whole = front.Within({});
  EXPECT_EQ(whole.points.size(), 101u);
  EXPECT_EQ(whole.pieces, 2);
  const FrontPart part =
      front.Within({{true, 0, 0.205, std::nullopt}, {true, 1, std::nullopt, -0.355}});
  ASSERT_EQ(part.points.size(), 20u);  // t = 0.21 to 0.40
  EXPECT_EQ(part.points.front(), 21);
  EXPECT_EQ(part.points.back(), 40);
  EXPECT_EQ(part.pieces, 1);
  EXPECT_NEAR(part.least_parameters[2], 1.05, 1e-12);
  EXPECT_NEAR(part.most_parameters[2], 2, 1e-12);
  EXPECT_NEAR(part.most_metrics[1], -0.36, 1e-12);
  const FrontPart upper = front.Within({{false, 1, 0.5, std::nullopt}});
  EXPECT_EQ(upper.points.front(), 50);
  EXPECT_TRUE(front.Within({{true, 0, 2.0, std::nullopt}}).points.empty());
}

TEST(FrontExploration, TellsWhichMetricsConflict) {
  const FrontPart line = FrontExploration(Parabola()).Within({{true, 0, 0.4, 0.45}});
  ASSERT_EQ(line.conflicts.size(), 1u);
  EXPECT_NEAR(line.conflicts[0].correlation, -1, 1e-3) << "nearly a straight line";

  // The third metric is twice the second: they go together.
  FrontPoints points = Plane();
  points.metrics.row(2) = 2 * points.metrics.row(1);
  const FrontPart part = FrontExploration(points).Within({});
  ASSERT_EQ(part.conflicts.size(), 3u);
  EXPECT_NEAR(part.conflicts[2].correlation, 1, 1e-12);
  EXPECT_NEAR(part.conflicts[0].correlation, part.conflicts[1].correlation, 1e-12);
  EXPECT_LT(part.conflicts[0].correlation, 0);
}

}  // namespace
}  // namespace mortise::pareto
