#include "services/pareto/sources/outlier_repair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

// The front is the quarter circle; its designs are a parabola over u1, u3 = 0.4, away from which
// they are worse by `penalty` times the distance.
ArchiveEntry EntryOnCircle(double along, double off, double penalty = 1e-3) {
  const VectorXd u = Eigen::Vector3d(along, along * along, 0.4 + off);
  const double angle = along * std::numbers::pi / 2, size = 1 + penalty * std::abs(off);
  return {u, true, Eigen::Vector2d(size * std::cos(angle), size * std::sin(angle)), {}, {}};
}

const Scaling kUnitScaling{VectorXd::Zero(2), VectorXd::Ones(2)};

TEST(OutlierRepair, PutsTheOddOnesBackIntoLineTheFurthestFirst) {
  Archive archive;
  for (int i = 0; i <= 40; ++i) {
    archive.Add(EntryOnCircle(i / 40.0, i == 0 ? 0.1 : i == 17 ? 0.3 : i == 18 ? 0.2 : 0));
  }
  ASSERT_EQ(archive.non_dominated().size(), 41u) << "nothing dominates the odd ones";
  const std::vector<VectorXd> repaired = RepairedOutliers(archive, kUnitScaling, 10);
  ASSERT_EQ(repaired.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(repaired[i][2], 0.4);
    EXPECT_GE(repaired[i].minCoeff(), 0);
    EXPECT_LE(repaired[i].maxCoeff(), 1);
  }
  EXPECT_DOUBLE_EQ(repaired[0][0], 17 / 40.0) << "what is in line stays as it is";
  EXPECT_DOUBLE_EQ(repaired[1][0], 18 / 40.0);
  EXPECT_EQ(RepairedOutliers(archive, kUnitScaling, 2).size(), 2u);
}

TEST(OutlierRepair, LeavesCurvedPiecesAndTheirEndsAlone) {
  Archive archive;
  for (int i = 0; i <= 40; ++i) archive.Add(EntryOnCircle(i / 40.0, 0));
  EXPECT_TRUE(RepairedOutliers(archive, kUnitScaling, 10).empty());
}

TEST(OutlierRepair, LeavesJumpsBetweenPiecesAlone) {
  Archive archive;
  for (int i = 0; i <= 40; ++i) archive.Add(EntryOnCircle(i / 40.0, i < 20 ? 0 : 0.5, 0));
  EXPECT_TRUE(RepairedOutliers(archive, kUnitScaling, 10).empty());
}

TEST(OutlierRepair, NeedsNeighbours) {
  Archive archive;
  for (int i = 0; i < 6; ++i) archive.Add(EntryOnCircle(i / 6.0, i == 3 ? 0.3 : 0));
  EXPECT_TRUE(RepairedOutliers(archive, kUnitScaling, 10).empty());
}

}  // namespace
}  // namespace mortise::pareto
