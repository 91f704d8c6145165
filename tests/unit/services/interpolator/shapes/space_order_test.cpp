#include "services/interpolator/shapes/space_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace mortise::interpolator {
namespace {

// Through the points of a cubic lattice of 2ⁿ a side Hilbert's curve runs from neighbour to
// neighbour.
TEST(SpaceOrder, RunsFromNeighbourToNeighbour) {
  const int side = 8;
  Eigen::Matrix3Xd points(3, side * side * side);
  for (int i = 0; i < points.cols(); ++i) {
    points.col(i) = Eigen::Vector3d(i % side, i / side % side, i / side / side);
  }
  std::vector<int> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), 0);
  SortInSpace(points, order);
  for (std::size_t i = 1; i < order.size(); ++i) {
    EXPECT_EQ((points.col(order[i]) - points.col(order[i - 1])).norm(), 1) << i;
  }
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], static_cast<int>(i));
}

TEST(SpaceOrder, KeepsTheOrderOfWhatLiesAtOnePlace) {
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Constant(3, 4, 0.3);
  std::vector<int> order = {2, 0, 3};
  SortInSpace(points, order);
  EXPECT_EQ(order, (std::vector<int>{2, 0, 3}));
}

}  // namespace
}  // namespace mortise::interpolator
