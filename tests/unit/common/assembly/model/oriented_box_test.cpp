// What separates two boxes.
#include "common/assembly/model/oriented_box.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace mortise::parametric {
namespace {

OrientedBox AnyBox(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0.1, 0.6);
  std::normal_distribution<double> normal;
  OrientedBox box;
  box.center = {normal(random) / 2, normal(random) / 2, normal(random) / 2};
  box.axes = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                 .normalized()
                 .toRotationMatrix();
  box.half_size = {uniform(random), uniform(random), uniform(random)};
  return box;
}

TEST(SeparationTest, OfBoxesSideBySideIsTheGapOrTheDepth) {
  OrientedBox a;
  a.half_size = {1, 2, 3};
  OrientedBox b = a;
  b.center = {2.5, 0.5, 1};
  EXPECT_NEAR(Separation(a, b), 0.5, 1e-12);
  b.center.x() = 2;
  EXPECT_NEAR(Separation(a, b), 0, 1e-12);
  b.center.x() = 1.75;
  EXPECT_NEAR(Separation(a, b), -0.25, 1e-12);
}

TEST(CommonPointTest, IsInTheMiddleOfWhereBoxesTouch) {
  OrientedBox a;
  a.half_size = {1, 2, 3};
  OrientedBox b = a;
  b.center = {2, 1, 3};
  EXPECT_TRUE(CommonPoint(a, b, 1e-9).isApprox(Eigen::Vector3d(1, 0.5, 1.5), 1e-9));
}

// Boxes are moved together until they just touch, however they are turned.
TEST(CommonPointTest, LiesInBothHoweverTheyTouch) {
  std::mt19937 random(3);
  const auto misses = [](const OrientedBox& box, const Eigen::Vector3d& point) {
    return ((box.axes.transpose() * (point - box.center)).cwiseAbs() - box.half_size).maxCoeff();
  };
  for (int i = 0; i < 200; ++i) {
    const OrientedBox a = AnyBox(random);
    OrientedBox b = AnyBox(random);
    const SeparatingAxis separating = FindSeparatingAxis(a, b);
    b.center -= (separating.distance + 1e-3) * separating.direction;
    if (Separation(a, b) > 0) continue;  // they pass each other
    const Eigen::Vector3d point = CommonPoint(a, b, 1e-9);
    EXPECT_LT(misses(a, point), 1e-8);
    EXPECT_LT(misses(b, point), 1e-8);
  }
}

// A cube that stands on its edge reaches half its diagonal.
TEST(SeparationTest, OfATurnedCubeIsMeasuredToItsEdge) {
  OrientedBox a;
  a.half_size = {0.5, 0.5, 0.5};
  OrientedBox b = a;
  b.axes = Eigen::AngleAxisd(std::acos(-1.0) / 4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  b.center = {2, 0, 0};
  EXPECT_NEAR(Separation(a, b), 2 - 0.5 - std::sqrt(0.5), 1e-12);
  // Edge over edge, crosswise: only a product of edges separates them.
  a.axes = Eigen::AngleAxisd(std::acos(-1.0) / 4, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_NEAR(Separation(a, b), 2 - 2 * std::sqrt(0.5), 1e-12);
}

TEST(SeparationTest, IsSymmetricAndTheSameWhereverOneStands) {
  std::mt19937 random(1);
  for (int round = 0; round < 500; ++round) {
    OrientedBox a = AnyBox(random);
    OrientedBox b = AnyBox(random);
    const double separation = Separation(a, b);
    EXPECT_NEAR(Separation(b, a), separation, 1e-12);
    const OrientedBox motion = AnyBox(random);
    for (OrientedBox* box : {&a, &b}) {
      box->center = motion.axes * box->center + motion.center;
      box->axes = motion.axes * box->axes;
    }
    EXPECT_NEAR(Separation(a, b), separation, 1e-9);
  }
}

// A box that is free of another has none of its points, and no motion shorter than the separation
// changes whether it is.
TEST(SeparationTest, AgreesWithPointsAndMotions) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  int apart = 0;
  for (int round = 0; round < 300; ++round) {
    const OrientedBox a = AnyBox(random);
    const OrientedBox b = AnyBox(random);
    const double separation = Separation(a, b);
    apart += separation > 0 ? 1 : 0;
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d within(uniform(random), uniform(random), uniform(random));
      const Eigen::Vector3d point = a.center + a.axes * within.cwiseProduct(a.half_size);
      const Eigen::Vector3d in_b = b.axes.transpose() * (point - b.center);
      if (separation > 0) {
        EXPECT_GT((in_b.cwiseAbs() - b.half_size).maxCoeff(), 0);
      }
      OrientedBox moved = b;
      const Eigen::Vector3d way = Eigen::Vector3d(normal(random), normal(random), normal(random));
      moved.center += 0.99 * std::abs(separation) * way.normalized();
      EXPECT_EQ(Separation(a, moved) > 0, separation > 0);
    }
  }
  EXPECT_GT(apart, 30);
  EXPECT_LT(apart, 270);
}

// Between the boxes along it there is as much room as it says.
TEST(SeparatingAxisTest, LeadsFromTheFirstToTheSecond) {
  std::mt19937 random(3);
  for (int round = 0; round < 500; ++round) {
    const OrientedBox a = AnyBox(random);
    const OrientedBox b = AnyBox(random);
    const SeparatingAxis axis = FindSeparatingAxis(a, b);
    EXPECT_NEAR(axis.direction.norm(), 1, 1e-12);
    double end_of_a = -1e9, begin_of_b = 1e9;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const auto reach = [&](const OrientedBox& box) {
        return axis.direction.dot(box.center + box.axes * signs.cwiseProduct(box.half_size));
      };
      end_of_a = std::max(end_of_a, reach(a));
      begin_of_b = std::min(begin_of_b, reach(b));
    }
    EXPECT_NEAR(begin_of_b - end_of_a, axis.distance, 1e-9);
  }
}

}  // namespace
}  // namespace mortise::parametric
