// Extracting fronts and labelling their pieces.
#include "services/pareto/front/front.h"

#include <gtest/gtest.h>

#include <cmath>

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
  ASSERT_EQ(front.pieces.size(), 2u);
  EXPECT_EQ(front.points.front().piece, 0);
  EXPECT_EQ(front.points.back().piece, 1);
  double previous = -1;
  for (const FrontPoint& point : front.points) {
    EXPECT_GT(point.embedding[0], previous);
    previous = point.embedding[0];
  }
}

TEST(FrontTest, TellsWhatSubspaceAPieceIsAndWhereDesignsJump) {
  const Front front = Line();
  for (const FrontPoint& point : front.points) {
    const FrontPiece& piece = front.pieces[point.piece];
    ASSERT_EQ(piece.directions.cols(), 1);
    const VectorXd offset = point.x - piece.origin;
    const VectorXd along = piece.directions.col(0);
    EXPECT_NEAR((offset - along * along.dot(offset) / along.squaredNorm()).norm(), 0, 1e-9);
    EXPECT_EQ(point.approximation_error, 0);
    // Neighbours are a twentieth apart but where the second parameter jumps from 0 to 1.
    const bool at_jump = point.x[0] == 4.5 || point.x[0] == 5;
    EXPECT_NEAR(point.jump, at_jump ? std::hypot(0.05, 1) : 0.05, 1e-9) << point.x.transpose();
  }
  EXPECT_EQ(front.pieces[0].points + front.pieces[1].points, 21);
}

// The nearest to the ideal of its cell is dominated by a design of the next cell, which is not the
// nearest of its own. The ends are there, though the lower one is not the nearest of its cell
// either.
TEST(FrontTest, DropsWhatIsDominatedFromAnotherCell) {
  const DesignSpace space{VectorXd::Zero(1), VectorXd::Ones(1)};
  Archive archive;
  const auto add = [&](double y1, double y2) {
    const double u = 0.01 * static_cast<double>(archive.size());
    archive.Add({VectorXd::Constant(1, u), true, Eigen::Vector2d(y1, y2), {}, {}});
  };
  add(0, 1);
  add(1, 0);
  const double boundary = std::tan(std::acos(-1) / 8);  // of the two cells, y2 / y1
  add(0.6, 0.6 * boundary + 0.001);                     // dominated, alone in the upper cell
  add(0.599, 0.599 * boundary - 0.001);                 // by this
  add(0.62, 0.05);                                      // the nearest of the lower cell
  add(0.48, 0.46);                                      // of the upper cell, behind the dominated
  PerformanceBuffer buffer({.cells_per_angle = 4}, 2);
  buffer.Rebuild(archive, archive.CurrentScaling());
  const Front front = BuildFront(space, archive, buffer, {});
  ASSERT_EQ(front.points.size(), 4u);
  EXPECT_EQ(front.points[0].entry, 1u);
  EXPECT_EQ(front.points[1].entry, 4u);
  EXPECT_EQ(front.points[2].entry, 5u);
  EXPECT_EQ(front.points[3].entry, 0u);
}

// Two designs for each trade-off: one on a line through design space, the other, better by less
// than the buffer tolerates, now here, now there.
TEST(FrontTest, PrefersAContinuousPieceToSlightlyBetterDesignsAllOver) {
  const DesignSpace space{VectorXd::Zero(2), VectorXd::Ones(2)};
  Archive archive;
  for (int i = 0; i <= 20; ++i) {
    const double t = i / 20.0;
    archive.Add({Eigen::Vector2d(t, 0.3), true, Eigen::Vector2d(t, 1 - t), {}, {}});
    if (i > 0 && i < 20) {
      const VectorXd better = 0.996 * Eigen::Vector2d(t, 1 - t);
      archive.Add({Eigen::Vector2d(t, i % 2 == 0 ? 0.8 : 0.9), true, better, {}, {}});
    }
  }
  PerformanceBuffer buffer({}, 2);
  buffer.Rebuild(archive, archive.CurrentScaling());
  const AffinePiece line{0, Eigen::Vector2d(0.5, 0.3), Eigen::Vector2d(1, 0)};
  const AffinePiece upper{0, Eigen::Vector2d(0.5, 0.8), Eigen::Vector2d(1, 0)};
  const AffinePiece uppermost{0, Eigen::Vector2d(0.5, 0.9), Eigen::Vector2d(1, 0)};
  const Front front = BuildFront(space, archive, buffer, {upper, line, line, uppermost});
  ASSERT_EQ(front.points.size(), 21u);
  EXPECT_EQ(front.pieces.size(), 1u);
  for (const FrontPoint& point : front.points) {
    EXPECT_EQ(point.x[1], 0.3);
    EXPECT_LE(point.approximation_error, buffer.tolerance());
    EXPECT_LE(point.jump, 0.05 + 1e-9);
  }
  EXPECT_GT(front.points[10].approximation_error, 0);
}

}  // namespace
}  // namespace mortise::pareto
