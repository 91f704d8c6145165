#include "services/pareto/sources/front_alignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

const Scaling kUnscaled{VectorXd::Zero(2), VectorXd::Ones(2)};

// The front is f1 + f2 = 1 for the best of the last parameter, 0.3, and further away for others; a
// design's place along it is the sum of the first two parameters.
ArchiveEntry PlacedAt(double along, double across) {
  const double size = 1 + std::abs(across - 0.3);
  return {Vector3d(along, along, across), true, Vector2d(size * along, size * (1 - along)), {}, {}};
}

// Trade-offs that are further from the front the further along, and one that is on it.
Archive OneOnTheFront() {
  Archive archive;
  for (int k = 0; k <= 20; ++k) archive.Add(PlacedAt(k / 20.0, 0.4 + 0.01 * (k % 3)));
  archive.Add(PlacedAt(0.525, 0.3));
  return archive;
}

TEST(FrontAlignment, FindsTheDirectionOfAFrontAlongTurnedParameters) {
  const FrontTrend trend(OneOnTheFront(), kUnscaled);
  const MatrixXd directions = trend.Directions(0.5);
  ASSERT_EQ(directions.cols(), 1);
  EXPECT_NEAR(std::abs(directions(0, 0)), std::numbers::sqrt2 / 2, 1e-9);
  EXPECT_NEAR(directions(1, 0), directions(0, 0), 1e-9);
  EXPECT_EQ(directions(2, 0), 0) << "the last parameter does not go with the metrics";
}

TEST(FrontAlignment, HasNoDirectionWhereDesignsAreTheSame) {
  Archive archive;
  for (const double f : {0.1, 0.4, 0.6, 0.9}) {
    archive.Add({Vector3d::Constant(0.5), true, Vector2d(f, 1 - f), {}, {}});
  }
  EXPECT_EQ(FrontTrend(archive, kUnscaled).Directions(0.1).cols(), 0);
}

TEST(FrontAlignment, BringsOtherTradeOffsToTheFrontThatOneHasReached) {
  Archive archive = OneOnTheFront();
  Random random(3);
  for (int round = 0; round < 10; ++round) {
    for (const VectorXd& u : AlignedDesigns(archive, kUnscaled, 8, random)) {
      EXPECT_GE(u.minCoeff(), 0);
      EXPECT_LE(u.maxCoeff(), 1);
      EXPECT_NEAR(u[0], u[1], 1e-9);
      archive.Add(PlacedAt(u[0], u[2]));
    }
  }
  for (const std::size_t entry : archive.non_dominated()) {
    EXPECT_NEAR(archive[entry].u[2], 0.3, 1e-9);
  }
  EXPECT_GT(archive.non_dominated().size(), 20u);
}

TEST(FrontAlignment, IsTheSameForASeed) {
  const Archive archive = OneOnTheFront();
  Random one(7), other(7);
  EXPECT_EQ(AlignedDesigns(archive, kUnscaled, 5, one),
            AlignedDesigns(archive, kUnscaled, 5, other));
}

TEST(FrontAlignment, NeedsSomeTradeOffsOfTwoMetrics) {
  Archive few, single;
  few.Add(PlacedAt(0.2, 0.3));
  few.Add(PlacedAt(0.7, 0.3));
  Random random(1);
  EXPECT_TRUE(AlignedDesigns(few, kUnscaled, 4, random).empty());
  for (const double u : {0.1, 0.2, 0.3}) {
    single.Add({VectorXd::Constant(1, u), true, VectorXd::Ones(1), {}, {}});
  }
  EXPECT_TRUE(AlignedDesigns(single, {VectorXd::Zero(1), VectorXd::Ones(1)}, 4, random).empty());
}

}  // namespace
}  // namespace mortise::pareto
