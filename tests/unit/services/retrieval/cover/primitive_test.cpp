// Distances from points and tangents (Figure 4-6).
#include "services/retrieval/cover/primitive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/random.h"

namespace mortise::retrieval {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

Primitive PointAt(const VectorXd& center) {
  return {.parameters = VectorXd(0),
          .center = center,
          .axes = Eigen::MatrixXd(center.size(), 0),
          .radii = VectorXd(0)};
}

// An ellipse in the plane z = 1, 3 along x and 1 along y.
Primitive Ellipse() {
  Primitive ellipse = PointAt(Vector3d(0, 0, 1));
  ellipse.axes = Eigen::MatrixXd::Identity(3, 2);
  ellipse.radii = Eigen::Vector2d(3, 1);
  return ellipse;
}

TEST(Primitive, CostsOneMoreThanItHasAxes) {
  EXPECT_EQ(Cost(PointAt(Vector3d(1, 2, 3))), 1);
  EXPECT_EQ(Cost(Ellipse()), 3);
}

TEST(Primitive, PointsDistanceIsEuclidean) {
  EXPECT_DOUBLE_EQ(Distance(PointAt(Vector3d(1, 2, 3)), Vector3d(1, 5, 7)), 5);
}

TEST(Primitive, AboveTheEllipseDistanceIsThatOfTheProjection) {
  EXPECT_NEAR(Distance(Ellipse(), Vector3d(2, 0.5, 3)), 2, 1e-12);
  EXPECT_NEAR(Distance(Ellipse(), Vector3d(2, 0.5, 1)), 0, 1e-7);
}

TEST(Primitive, BeyondAnAxisDistanceIsThatOfItsEnd) {
  EXPECT_NEAR(Distance(Ellipse(), Vector3d(6, 0, 5)), 5, 1e-12);
  EXPECT_NEAR(Distance(Ellipse(), Vector3d(0, -2, 1)), 1, 1e-12);
}

TEST(Primitive, BesideTheEllipseDistanceGoesAlongTheScaledRay) {
  // (3, 1) has length √2 in the ellipse's scale, so the place is (3, 1) / √2.
  EXPECT_NEAR(Distance(Ellipse(), Vector3d(3, 1, 1)), std::sqrt(10.0) * (1 - std::sqrt(0.5)),
              1e-12);
}

TEST(Primitive, DistanceIsThatOfThePlaceAndNeverBelowTheBound) {
  Random random(3);
  const Primitive ellipse = Ellipse();
  for (int i = 0; i < 1000; ++i) {
    const VectorXd x = 5 * random.Uniform() * random.UnitVector(3);
    const double distance = Distance(ellipse, x);
    EXPECT_NEAR(distance, (PlaceNear(ellipse, x) - x).norm(), 1e-7);
    EXPECT_GE(distance, DistanceBound(ellipse, x) - 1e-12);
    const VectorXd place = PlaceNear(ellipse, x) - ellipse.center;
    EXPECT_LE(place.head(2).cwiseQuotient(ellipse.radii).norm(), 1 + 1e-12);
  }
}

}  // namespace
}  // namespace mortise::retrieval
