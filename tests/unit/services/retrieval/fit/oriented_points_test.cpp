#include "services/retrieval/fit/oriented_points.h"

#include <gtest/gtest.h>

#include "common/base/random.h"

namespace mortise::retrieval {
namespace {

TEST(OrientedPointsTest, FindsWhatLookingAtEachFinds) {
  Random random(1);
  Eigen::Matrix3Xd points(3, 500), normals(3, 500);
  for (int i = 0; i < 500; ++i) {
    points.col(i) = random.Uniform() * random.UnitVector(3);
    normals.col(i) = random.UnitVector(3);
  }
  const double length = 0.2;
  const OrientedPoints tree(points, normals, length);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d point = random.UnitVector(3), normal = random.UnitVector(3);
    const auto squares = [&](const Eigen::Vector3d& way) {
      return ((points.colwise() - point).colwise().squaredNorm() +
              length * length * (normals.colwise() - way).colwise().squaredNorm())
          .eval();
    };
    Eigen::Index same = 0, opposite = 0;
    const double to_same = squares(normal).minCoeff(&same);
    const double to_opposite = squares(-normal).minCoeff(&opposite);
    EXPECT_EQ(tree.Find(point, normal).index, same);
    EXPECT_NEAR(tree.Find(point, normal).squared, to_same, 1e-12);
    EXPECT_EQ(tree.FindEitherWay(point, normal).index, to_opposite < to_same ? opposite : same);
  }
}

TEST(OrientedPointsTest, TellsTheFacesOfAThinBoardApart) {
  Eigen::Matrix3Xd points(3, 2), normals(3, 2);
  points << 0, 0, 0, 0, 0.01, -0.01;
  normals << 0, 0, 0, 0, 1, -1;
  const OrientedPoints tree(points, normals, 0.1);
  EXPECT_EQ(tree.Find({0, 0, -0.05}, {0, 0, 1}).index, 0);
  EXPECT_EQ(tree.Find({0, 0, 0.05}, {0, 0, -1}).index, 1);
  EXPECT_EQ(tree.FindEitherWay({0, 0, 0.05}, {0, 0, -1}).index, 0);
}

}  // namespace
}  // namespace mortise::retrieval
