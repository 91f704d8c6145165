// Polygons: areas, simplicity, triangulation and overlaps.
#include "common/design/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace mortise::parametric {
namespace {

Eigen::Matrix2Xd Make(std::initializer_list<std::array<double, 2>> corners) {
  Eigen::Matrix2Xd polygon(2, static_cast<Eigen::Index>(corners.size()));
  Eigen::Index next = 0;
  for (const auto& [u, v] : corners) polygon.col(next++) << u, v;
  return polygon;
}

// A star-shaped polygon around the origin: simple, and mostly not convex.
Eigen::Matrix2Xd RandomStar(int corners, std::mt19937& random) {
  std::uniform_real_distribution<double> radius(0.2, 1.0);
  Eigen::Matrix2Xd polygon(2, corners);
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    const double r = radius(random);
    polygon.col(i) << r * std::cos(angle), r * std::sin(angle);
  }
  return polygon;
}

double TotalArea(const std::vector<Eigen::Matrix2Xd>& pieces) {
  double area = 0;
  for (const auto& piece : pieces) area += SignedArea(piece);
  return area;
}

const Eigen::Matrix2Xd kSquare = Make({{0, 0}, {1, 0}, {1, 1}, {0, 1}});

TEST(Polygon, TellsSimpleFromTangled) {
  EXPECT_TRUE(IsSimple(kSquare, 1e-6));
  EXPECT_FALSE(IsSimple(Make({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), 1e-6));             // bow tie
  EXPECT_FALSE(IsSimple(Make({{0, 0}, {1, 0}, {1, 0}, {0, 1}}), 1e-6));             // corner twice
  EXPECT_FALSE(IsSimple(Make({{0, 0}, {2, 0}, {1, 0}, {0, 1}}), 1e-6));             // doubles back
  EXPECT_FALSE(IsSimple(Make({{0, 0}, {2, 0}, {1, 1e-9}, {2, 1}, {0, 1}}), 1e-6));  // a touch
  EXPECT_FALSE(IsSimple(Make({{0, 0}, {1, 0}}), 1e-6));
}

TEST(Polygon, TrianglesCoverThePolygonOnce) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Matrix2Xd polygon = RandomStar(3 + trial % 30, random);
    const auto triangles = Triangulate(polygon);
    ASSERT_EQ(triangles.size(), static_cast<std::size_t>(polygon.cols()) - 2);
    double area = 0;
    for (const auto& [a, b, c] : triangles) {
      Eigen::Matrix2Xd triangle(2, 3);
      triangle << polygon.col(a), polygon.col(b), polygon.col(c);
      EXPECT_GT(SignedArea(triangle), 0);
      area += SignedArea(triangle);
    }
    EXPECT_NEAR(area, SignedArea(polygon), 1e-12);
  }
}

TEST(Polygon, TriangulatesCollinearCorners) {
  const auto polygon = Make({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}});
  double area = 0;
  for (const auto& [a, b, c] : Triangulate(polygon)) {
    Eigen::Matrix2Xd triangle(2, 3);
    triangle << polygon.col(a), polygon.col(b), polygon.col(c);
    area += SignedArea(triangle);
  }
  EXPECT_NEAR(area, 2, 1e-12);
}

TEST(Polygon, OverlapOfRectanglesIsExact) {
  const auto shifted = Make({{0.25, -1}, {3, -1}, {3, 0.5}, {0.25, 0.5}});
  const auto pieces = Intersect(kSquare, shifted, 1e-6);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(SignedArea(pieces[0]), 0.75 * 0.5, 1e-15);
  EXPECT_TRUE(Intersect(kSquare, Make({{1, 0}, {2, 0}, {2, 1}, {1, 1}}), 1e-6).empty());
}

// The area of an overlap is what many random points say it is, and does not depend on the order.
TEST(Polygon, OverlapOfStarsMatchesSampling) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::Matrix2Xd a = RandomStar(9, random);
    const Eigen::Matrix2Xd b = RandomStar(12, random).colwise() + Eigen::Vector2d(0.3, 0.1);
    const double area = TotalArea(Intersect(a, b, 1e-9));
    EXPECT_NEAR(area, TotalArea(Intersect(b, a, 1e-9)), 1e-9);
    int inside = 0;
    constexpr int kSamples = 40000;
    for (int i = 0; i < kSamples; ++i) {
      const Eigen::Vector2d point(uniform(random), uniform(random));
      inside += Contains(a, point, 0) && Contains(b, point, 0);
    }
    EXPECT_NEAR(area, 4.0 * inside / kSamples, 0.03);
  }
}

}  // namespace
}  // namespace mortise::parametric
