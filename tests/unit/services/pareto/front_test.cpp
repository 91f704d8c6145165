// Picking from fronts and labelling their pieces.
#include "services/pareto/front.h"

#include <gtest/gtest.h>

#include <limits>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

Front Line() {
  const DesignSpace space{VectorXd::Zero(2), VectorXd::Constant(2, 10)};
  Archive archive;
  for (int i = 0; i <= 20; ++i) {
    // Two pieces: the second parameter jumps at the middle.
    const VectorXd u = Eigen::Vector2d(i / 20.0, i < 10 ? 0.0 : 1.0);
    archive.Add({u, true, Eigen::Vector2d(i, 20 - i), {}, {}});
  }
  archive.Add({Eigen::Vector2d(0.5, 0.5), true, Eigen::Vector2d(15, 15), {}, {}});
  PerformanceBuffer buffer({}, 2);
  buffer.Rebuild(archive, archive.CurrentScaling());
  const std::vector<AffinePiece> pieces = {{3, Eigen::Vector2d(0.15, 0), Eigen::Vector2d(1, 0)},
                                           {15, Eigen::Vector2d(0.75, 1), Eigen::Vector2d(1, 0)}};
  return BuildFront(space, archive, buffer, pieces);
}

TEST(FrontTest, DropsDominatedPointsAndLabelsPiecesInOrder) {
  const Front front = Line();
  ASSERT_EQ(front.points.size(), 21u);
  EXPECT_EQ(front.pieces, 2);
  EXPECT_EQ(front.points.front().piece, 0);
  EXPECT_EQ(front.points.back().piece, 1);
  double previous = -1;
  for (const FrontPoint& point : front.points) {
    EXPECT_GT(point.embedding[0], previous);
    previous = point.embedding[0];
  }
}

TEST(FrontTest, PicksTheNearest) {
  const Front front = Line();
  EXPECT_EQ(PickAtMetric(front, 0, 7.2)->metrics[0], 7);
  EXPECT_EQ(PickAtMetric(front, 1, 100)->metrics[1], 20);
  EXPECT_EQ(PickAtEmbedding(front, VectorXd::Constant(1, 0))->metrics[1], 0);
  EXPECT_EQ(PickAtEmbedding(front, VectorXd::Constant(1, 0.5))->metrics[0], 10);
}

TEST(FrontTest, RefusesBadPositions) {
  const Front front = Line();
  EXPECT_TRUE(absl::IsInvalidArgument(PickAtEmbedding(front, VectorXd::Zero(2)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(PickAtEmbedding(front, VectorXd::Constant(1, 2)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(PickAtMetric(front, 2, 0).status()));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(absl::IsInvalidArgument(PickAtMetric(front, 0, nan).status()));
  EXPECT_TRUE(absl::IsFailedPrecondition(PickAtMetric(Front(), 0, 1).status()));
}

}  // namespace
}  // namespace mortise::pareto
