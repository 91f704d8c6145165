#include "services/retrieval/fit/query_points.h"

#include <gtest/gtest.h>

#include "tests/unit/services/retrieval/descriptors/furniture.h"
#include "tests/unit/services/retrieval/fit/scans.h"

namespace mortise::retrieval {
namespace {

TEST(QueryPointsTest, LieOnTheSurface) {
  const auto points = MakeQueryPoints(Box({0, 0, 0}, {1, 2, 3}), 500, 1);
  ASSERT_TRUE(points.ok()) << points.status();
  EXPECT_EQ(points->size(), 500);
  EXPECT_EQ(points->noise, 0);
  EXPECT_EQ(points->places, points->smoothed);
  for (Eigen::Index i = 0; i < points->size(); ++i) {
    const Eigen::Vector3d place = points->places.col(i), normal = points->normals.col(i);
    // In the plane of the face that the normal tells.
    const Eigen::Vector3d face = normal.cwiseMax(0).cwiseProduct(Eigen::Vector3d(1, 2, 3));
    EXPECT_NEAR(normal.dot(place - face), 0, 1e-12);
  }
}

TEST(QueryPointsTest, AreToldApartInSpiteOfNoise) {
  Random random(6);
  // Noise of half the board's thickness.
  mesh::SurfaceMesh board = testing::Refined(Box({0, 0, 0}, {1, 1, 0.02}), 0.02);
  testing::AddNoise(board, 0.01, random);
  const auto points = MakeQueryPoints(board, 1000, 1);
  ASSERT_TRUE(points.ok()) << points.status();
  int right = 0;
  double off = 0, off_smoothed = 0;
  for (Eigen::Index i = 0; i < points->size(); ++i) {
    const double face = points->normals(2, i) > 0 ? 0.02 : 0;
    if (std::abs(points->normals(2, i)) > 0.8) ++right;
    off += std::pow(points->places(2, i) - face, 2);
    off_smoothed += std::pow(points->smoothed(2, i) - face, 2);
  }
  EXPECT_GT(right, 700);
  EXPECT_LT(off_smoothed, 0.6 * off);
}

TEST(QueryPointsTest, KeepAnEvenPart) {
  const auto points = MakeQueryPoints(Box({0, 0, 0}, {1, 2, 3}), 500, 1);
  ASSERT_TRUE(points.ok());
  const QueryPoints part = EvenPart(*points, 100);
  EXPECT_EQ(part.size(), 100);
  EXPECT_EQ(part.places.col(1), points->places.col(5));
  EXPECT_EQ(EvenPart(*points, 1000).size(), 500);
}

}  // namespace
}  // namespace mortise::retrieval
