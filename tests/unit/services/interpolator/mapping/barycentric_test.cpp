#include "services/interpolator/mapping/barycentric.h"

#include <gtest/gtest.h>

#include "tests/support/status_assertions.h"

namespace mortise::interpolator {
namespace {

TEST(BarycentricTest, FindsPlacesInTriangles) {
  const Eigen::Matrix3d corners{{0, 2, 0}, {0, 0, 4}, {1, 1, 1}};
  const Eigen::Vector3d shares(0.2, 0.5, 0.3);
  EXPECT_LT((BarycentricIn(corners, corners * shares) - shares).norm(), 1e-15);
  const Eigen::Vector3d above = corners * shares + Eigen::Vector3d(0, 0, 5);
  EXPECT_LT((BarycentricIn(corners, above) - shares).norm(), 1e-15);
}

TEST(BarycentricTest, KeepsPointsOutsideWithin) {
  const Eigen::Matrix3d corners{{0, 2, 0}, {0, 0, 4}, {1, 1, 1}};
  const Eigen::Vector3d shares = BarycentricIn(corners, {1, -3, 1});
  EXPECT_GE(shares.minCoeff(), 0);
  EXPECT_DOUBLE_EQ(shares.sum(), 1);
  EXPECT_EQ(shares[2], 0);
}

TEST(BarycentricTest, TakesTheLongestSideOfWhatIsFlat) {
  const Eigen::Matrix3d line{{0, 1, 4}, {0, 0, 0}, {0, 0, 0}};
  EXPECT_LT((line * BarycentricIn(line, {3, 1, 0}) - Eigen::Vector3d(3, 0, 0)).norm(), 1e-15);
  const Eigen::Matrix3d point = Eigen::Matrix3d::Ones();
  EXPECT_DOUBLE_EQ(BarycentricIn(point, {3, 1, 0}).sum(), 1);
}

}  // namespace
}  // namespace mortise::interpolator
