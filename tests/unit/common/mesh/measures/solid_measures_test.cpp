// Shadows, standing and floating of solids, against what geometry and naval architecture give.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "common/base/errors.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/measures/floating_solid.h"
#include "common/mesh/measures/silhouette.h"
#include "common/mesh/measures/standing_solid.h"
#include "tests/unit/common/mesh/box_assembly.h"
#include "tests/unit/common/mesh/round_solids.h"

namespace mortise::mesh {
namespace {

using Eigen::Vector3d;
using Solids = std::vector<SurfaceMesh>;
constexpr double kPi = std::numbers::pi;

double UnitNumber(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

Vector3d AnyVector(std::mt19937_64& random) {
  return Vector3d(UnitNumber(random), UnitNumber(random), UnitNumber(random)) * 2 -
         Vector3d::Ones();
}

Eigen::Matrix3d AnyRotation(std::mt19937_64& random) {
  const Vector3d a = AnyVector(random);
  return Eigen::AngleAxisd(3 * UnitNumber(random), a.normalized()).toRotationMatrix();
}

// The area of a regular polygon around a circle's centre.
double PolygonArea(double radius, int sides) {
  return 0.5 * sides * radius * radius * std::sin(2 * kPi / sides);
}

TEST(ProjectedArea, OfABoxFromAnywhere) {
  const Vector3d size(0.3, 0.5, 0.7);
  const Solids box{BoxSurface(Vector3d(100, -20, 3), Vector3d(100, -20, 3) + size)};
  std::mt19937_64 random(1);
  for (int i = 0; i < 50; ++i) {
    const Vector3d way = i < 3 ? Vector3d(Vector3d::Unit(i)) : AnyVector(random).normalized();
    const double expected =
        way.cwiseAbs().dot(Vector3d(size.y() * size.z(), size.z() * size.x(), size.x() * size.y()));
    EXPECT_NEAR(ProjectedArea(box, 3 * way), expected, 1e-8);
    EXPECT_NEAR(ProjectedArea(box, -way), expected, 1e-8);
  }
}

TEST(ProjectedArea, OfRoundSolids) {
  EXPECT_NEAR(ProjectedArea(Solids{Cylinder(0.2, 0.5, 32)}, Vector3d::UnitZ()),
              PolygonArea(0.2, 32), 1e-9);
  EXPECT_NEAR(ProjectedArea(Solids{Cylinder(0.2, 0.5, 32)}, Vector3d::UnitX()), 0.4 * 0.5, 1e-9);
  EXPECT_NEAR(ProjectedArea(Solids{Sphere(1, 100)}, {0.3, -0.2, 0.9}), kPi, 1e-3 * kPi);
  // The hole of a ring is in its shadow too, unless light comes from the side.
  const Solids ring{Torus(0.5, 0.1, 48)};
  EXPECT_NEAR(ProjectedArea(ring, Vector3d::UnitZ()), PolygonArea(0.6, 48) - PolygonArea(0.4, 48),
              1e-8);
  EXPECT_NEAR(ProjectedArea(ring, Vector3d::UnitX()), 4 * 0.5 * 0.1 + kPi * 0.01, 1e-3);
}

TEST(ProjectedArea, CountsWhatIsHiddenOnce) {
  const SurfaceMesh box = BoxSurface(Vector3d::Zero(), Vector3d::Ones());
  // Behind each other, beside each other, half behind each other, one within the other's shadow.
  const auto area = [&](const Vector3d& offset, const SurfaceMesh& other) {
    return ProjectedArea(Solids{box, Moved(other, offset)}, Vector3d::UnitX());
  };
  EXPECT_NEAR(area({2, 0, 0}, box), 1, 1e-8);
  EXPECT_NEAR(area({0, 1, 0}, box), 2, 1e-8);
  EXPECT_NEAR(area({2, 0.5, 0.5}, box), 1.75, 1e-8);
  EXPECT_NEAR(area({3, 0.5, 0.5}, Sphere(0.3, 20)), 1, 1e-8);
}

// Whatever turns along with the light casts the same shadow, and a shadow is at most the sum of the
// shadows and at least the largest of them.
TEST(ProjectedArea, KeepsItsInvariants) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 40; ++round) {
    Solids solids, turned;
    const Eigen::Matrix3d rotation = AnyRotation(random);
    const Vector3d way = AnyVector(random);
    double sum = 0, largest = 0;
    for (int i = 0; i < 1 + round % 5; ++i) {
      const SurfaceMesh shape = i % 2 == 0 ? Torus(0.8, 0.2, 16) : Sphere(0.4, 12);
      solids.push_back(Moved(Rotated(shape, AnyRotation(random)), AnyVector(random)));
      turned.push_back(Rotated(solids.back(), rotation));
      const double area = ProjectedArea(Solids{solids.back()}, way);
      sum += area;
      largest = std::max(largest, area);
    }
    const double area = ProjectedArea(solids, way);
    EXPECT_LE(area, sum * (1 + 1e-7));
    EXPECT_GE(area, largest * (1 - 1e-7));
    EXPECT_NEAR(ProjectedArea(turned, rotation * way), area, 1e-6 * area);
  }
}

// Four triangles at one edge of one surface.
TEST(ProjectedArea, OfASolidThatTouchesItselfAlongAnEdge) {
  const SurfaceMesh near = BoxSurface({0, 0, 0}, {1, 1, 1});
  const SurfaceMesh far = BoxSurface({1, 1, 0}, {2, 2, 1});
  SurfaceMesh both;
  both.vertices.resize(3, 16);
  both.vertices << near.vertices, far.vertices;
  both.triangles.resize(3, 24);
  both.triangles << near.triangles, far.triangles.array() + 8;
  for (int& vertex : both.triangles.reshaped()) {
    for (int other = 0; other < 8; ++other) {
      if (both.vertices.col(other) == both.vertices.col(vertex)) vertex = other;
    }
  }
  std::mt19937_64 random(4);
  for (int i = 0; i < 50; ++i) {
    const Vector3d way = AnyVector(random).normalized();
    EXPECT_NEAR(ProjectedArea(Solids{both}, way), ProjectedArea(Solids{near, far}, way), 1e-8);
  }
}

TEST(ProjectedArea, OfNothingIsNothing) {
  EXPECT_EQ(ProjectedArea({}, Vector3d::UnitX()), 0);
  EXPECT_EQ(ProjectedArea(Solids{SurfaceMesh{}}, Vector3d::UnitX()), 0);
}

TEST(Standing, OfABox) {
  const Solids box{BoxSurface({-0.2, -0.3, 1}, {0.2, 0.3, 2})};
  const Standing middle = StandOnFloor(box, {0, 0, 1.5});
  EXPECT_NEAR(middle.margin, 0.2, 1e-12);
  EXPECT_NEAR(middle.angle, std::atan(0.2 / 0.5), 1e-12);
  EXPECT_NEAR(StandOnFloor(box, {0.15, 0, 1.5}).margin, 0.05, 1e-12);
  const Standing toppling = StandOnFloor(box, {0.5, 0.7, 1.5});
  EXPECT_NEAR(toppling.margin, -0.5, 1e-12);
  EXPECT_NEAR(toppling.angle, -kPi / 4, 1e-12);
}

// The polygon spans the feet, not what is above them.
TEST(Standing, OfATableOnThreeFeet) {
  const Solids table{BoxSurface({0, 0, 0}, {0.1, 0.1, 0.7}), BoxSurface({0.9, 0, 0}, {1, 0.1, 0.7}),
                     BoxSurface({0, 0.9, 0}, {0.1, 1, 0.7}), BoxSurface({0, 0, 0.7}, {1, 1, 0.75})};
  // The longest edge runs from (1, 0.1) to (0.1, 1).
  EXPECT_NEAR(StandOnFloor(table, {0.5, 0.5, 0.6}).margin, 0.1 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(StandOnFloor(table, {0.6, 0.6, 0.6}).margin, -0.1 / std::sqrt(2.0), 1e-12);
}

TEST(Standing, OnALineAndOnAPoint) {
  Eigen::Matrix3d lying;
  lying << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  const Solids roller{Rotated(Cylinder(0.1, 0.5, 32), lying)};
  EXPECT_NEAR(StandOnFloor(roller, {0.25, 0, 0}).margin, 0, 1e-12);
  EXPECT_NEAR(StandOnFloor(roller, {0.25, 0.03, 0}).margin, -0.03, 1e-9);
  const Solids top{Turned({{1e-9, 0}, {0.1, 0.1}}, 16)};
  EXPECT_NEAR(StandOnFloor(top, {0.03, 0.04, 0.07}).margin, -0.05, 1e-6);
  EXPECT_EQ(StandOnFloor({}, Vector3d::Zero()).margin, 0);
}

TEST(Standing, FallsOverTheNearestEdge) {
  const Solids box{BoxSurface({-0.2, -0.3, 1}, {0.2, 0.3, 2})};
  EXPECT_TRUE(StandOnFloor(box, {0.05, 0, 1.5}).falls_towards.isApprox(Eigen::Vector2d(1, 0)));
  EXPECT_TRUE(StandOnFloor(box, {0, -0.25, 1.5}).falls_towards.isApprox(Eigen::Vector2d(0, -1)));
  // Beyond a corner it falls away from the corner.
  EXPECT_TRUE(
      StandOnFloor(box, {0.5, 0.7, 1.5}).falls_towards.isApprox(Eigen::Vector2d(0.6, 0.8), 0.1));
}

TEST(Standing, IsOnTheCornersOfWhatTouchesTheFloor) {
  const Support support = SupportOf(Solids{BoxSurface({0, 0, 0.5}, {0.1, 0.1, 1}),
                                           BoxSurface({0.9, 0.9, 0.5}, {1, 1, 1}),
                                           BoxSurface({-1, -1, 0.6}, {2, 2, 1})});
  EXPECT_EQ(support.floor, 0.5);
  EXPECT_EQ(support.corners.cols(), 6);
  EXPECT_TRUE(support.corners.rowwise().minCoeff().isZero());
  EXPECT_TRUE(support.corners.rowwise().maxCoeff().isOnes());
  EXPECT_EQ(SupportOf({}).corners.cols(), 0);
}

// A force that is as far beyond an edge as the weight is within it tips at the weight.
TEST(Standing, TipsWhereTheMomentsAreEqual) {
  const Support support = SupportOf(Solids{BoxSurface({0, 0, 0}, {1, 1, 1})});
  const Vector3d middle(0.5, 0.5, 0.5);
  EXPECT_NEAR(TippingForce(support, middle, 100, {1.5, 0.5}), 100, 1e-9);
  EXPECT_NEAR(TippingForce(support, middle, 100, {1.25, 0.5}), 200, 1e-9);
  EXPECT_NEAR(TippingForce(support, middle, 100, {0.5, -0.1}), 500, 1e-9);
  // Beyond two edges it tips over the one that it is further beyond.
  EXPECT_NEAR(TippingForce(support, middle, 100, {1.5, 1.25}), 100, 1e-9);
  EXPECT_EQ(TippingForce(support, middle, 100, {0.9, 0.9}),
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(TippingForce(support, {1.1, 0.5, 0.5}, 100, {0.5, 0.5}), 0);
  EXPECT_EQ(TippingForce(Support(), middle, 100, {0.5, 0.5}), 0);
}

TEST(Floating, OfABox) {
  const Vector3d size(1.2, 0.8, 0.5);
  const Solids box{BoxSurface(Vector3d(3, 4, 5), Vector3d(3, 4, 5) + size)};
  const double mass = 0.6 * 1000 * size.prod();
  const auto floating = FloatUpright(box, mass, Vector3d(3, 4, 5) + size / 2, 1000);
  ASSERT_TRUE(floating.ok()) << floating.status();
  const double draught = 0.6 * 0.5;
  EXPECT_NEAR(floating->displaced_volume, 0.6 * size.prod(), 1e-12);
  EXPECT_NEAR(floating->draught, draught, 1e-10);
  EXPECT_NEAR(floating->freeboard, 0.5 - draught, 1e-10);
  // KB = T / 2, BM = b² / (12 T), KG = h / 2.
  EXPECT_NEAR(floating->metacentric_height, draught / 2 + 0.64 / (12 * draught) - 0.25, 1e-9);
}

// A pyramid on its tip: the water line of a cone scales with the cube root of its mass.
TEST(Floating, OfAConeOnItsTip) {
  const double height = 0.4, radius = 0.3, share = 0.3;
  const Solids cone{Turned({{1e-9, 0}, {radius, height}}, 96)};
  const double volume = ComputeMassProperties(cone[0]).volume;
  const auto floating = FloatUpright(cone, share * 1000 * volume, {0, 0, 0.75 * height}, 1000);
  ASSERT_TRUE(floating.ok()) << floating.status();
  const double draught = height * std::cbrt(share);
  EXPECT_NEAR(floating->draught, draught, 1e-6);
  // KB = ¾ T; BM is π r⁴ / 4 over π r² T / 3, with r the radius at the water.
  const double at_water = radius * draught / height;
  EXPECT_NEAR(floating->metacentric_height,
              0.75 * draught + 0.75 * at_water * at_water / draught - 0.75 * height, 5e-4);
}

TEST(Floating, OfASphereAndACylinder) {
  // A sphere of half the water's density lies half in it; its metacentre is its centre.
  const Solids ball{Sphere(0.25, 60)};
  const double mass = 500 * ComputeMassProperties(ball[0]).volume;
  const auto half = FloatUpright(ball, mass, {0, 0, -0.05}, 1000);
  ASSERT_TRUE(half.ok()) << half.status();
  EXPECT_NEAR(half->draught, 0.25, 1e-3);
  EXPECT_NEAR(half->metacentric_height, 0.05, 1e-3);
  // A log that stands upright capsizes.
  const Solids log{Cylinder(0.1, 1, 48)};
  const auto standing =
      FloatUpright(log, 0.7 * 1000 * ComputeMassProperties(log[0]).volume, {0, 0, 0.5}, 1000);
  ASSERT_TRUE(standing.ok()) << standing.status();
  EXPECT_NEAR(standing->draught, 0.7, 1e-9);
  EXPECT_NEAR(standing->metacentric_height, 0.35 + 0.01 / (4 * 0.7) - 0.5, 1e-4);
}

// Parts that touch float as the one body that they are.
TEST(Floating, OfPartsIsThatOfTheWhole) {
  const Vector3d size(1, 0.6, 0.4);
  const Solids whole{BoxSurface(Vector3d::Zero(), size)};
  const Solids parts{BoxSurface({0, 0, 0}, {1, 0.6, 0.15}),
                     BoxSurface({0, 0, 0.15}, {0.4, 0.6, 0.4}),
                     BoxSurface({0.4, 0, 0.15}, {1, 0.6, 0.4})};
  const auto one = FloatUpright(whole, 150, size / 2, 1000);
  const auto several = FloatUpright(parts, 150, size / 2, 1000);
  ASSERT_TRUE(one.ok() && several.ok());
  EXPECT_NEAR(one->draught, several->draught, 1e-10);
  EXPECT_NEAR(one->metacentric_height, several->metacentric_height, 1e-9);
}

TEST(Floating, HeavierLiesDeeper) {
  const Solids ring{Moved(Torus(0.5, 0.1, 24), {3, 2, 1})};
  const double whole = 1000 * ComputeMassProperties(ring[0]).volume;
  double draught = 0;
  for (int i = 1; i < 20; ++i) {
    const auto floating = FloatUpright(ring, whole * i / 20, {3, 2, 1}, 1000);
    ASSERT_TRUE(floating.ok()) << floating.status();
    EXPECT_GT(floating->draught, draught);
    EXPECT_NEAR(floating->draught + floating->freeboard, 0.2, 1e-12);
    draught = floating->draught;
  }
}

TEST(Floating, SaysWhatSinks) {
  const Solids box{BoxSurface(Vector3d::Zero(), Vector3d::Ones())};
  const absl::Status status = FloatUpright(box, 7850, {0.5, 0.5, 0.5}, 1000).status();
  EXPECT_EQ(DetailOf(status).reason, "SINKS");
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("7850 kg"));
  EXPECT_FALSE(FloatUpright({}, 1, Vector3d::Zero(), 1000).ok());
}

}  // namespace
}  // namespace mortise::mesh
