#include "services/retrieval/fit/welded_surface.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"
#include "tests/unit/services/retrieval/fit/scans.h"

namespace mortise::retrieval {
namespace {

// How much of the area looks away from the middle of the box.
double PartOutwards(const WeldedSurface& surface) {
  double outwards = 0, whole = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d at =
        surface.vertices(Eigen::all, surface.triangles.col(t)).rowwise().mean();
    whole += surface.areas.col(t).norm();
    if (surface.areas.col(t).dot(at) > 0) outwards += surface.areas.col(t).norm();
  }
  return outwards / whole;
}

TEST(WeldedSurfaceTest, TurnsTrianglesOutwards) {
  Random random(3);
  mesh::SurfaceMesh box = testing::Refined(Box({-1, -0.5, -0.05}, {1, 0.5, 0.05}), 0.2);
  testing::CutHoles(box, 0.2, 3, random);
  for (Eigen::Index t = 0; t < box.triangles.cols(); ++t) {
    if (random.Uniform() < 0.5) std::swap(box.triangles(0, t), box.triangles(1, t));
  }
  const auto welded = Weld(box);
  ASSERT_TRUE(welded.ok()) << welded.status();
  EXPECT_NEAR(PartOutwards(*welded), 1, 1e-9);
  EXPECT_TRUE(welded->sided[0]);
}

TEST(WeldedSurfaceTest, JoinsTrianglesThatShareNoVertices) {
  const mesh::SurfaceMesh box = Box({0, 0, 0}, {1, 1, 1});
  mesh::SurfaceMesh soup{Eigen::Matrix3Xd(3, 36), Eigen::Matrix3Xi(3, 12)};
  for (int t = 0; t < 12; ++t) {
    soup.vertices.middleCols(3 * t, 3) = box.vertices(Eigen::all, box.triangles.col(t));
    soup.triangles.col(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  }
  const auto welded = Weld(soup);
  ASSERT_TRUE(welded.ok()) << welded.status();
  EXPECT_EQ(welded->vertices.cols(), 8);
  EXPECT_GE(welded->neighbours.minCoeff(), 0);
  for (Eigen::Index t = 0; t < 12; ++t) {
    for (int k = 0; k < 3; ++k) {
      const int next = welded->neighbours(k, t);
      EXPECT_EQ((welded->neighbours.col(next).array() == t).count(), 1);
    }
  }
}

TEST(WeldedSurfaceTest, KnowsThatASheetHasNoOutside) {
  const auto sheet = Weld(testing::Refined(Box({0, 0, 0}, {1, 1, 0}), 0.2));
  ASSERT_TRUE(sheet.ok()) << sheet.status();
  EXPECT_FALSE(sheet->sided[0]);
}

TEST(WeldedSurfaceTest, EstimatesNoise) {
  for (const double deviation : {0.0, 0.003, 0.01}) {
    Random random(8);
    mesh::SurfaceMesh box = testing::Refined(Box({0, 0, 0}, {1, 0.8, 0.6}), 0.05);
    testing::AddNoise(box, deviation, random);
    const auto welded = Weld(box);
    ASSERT_TRUE(welded.ok()) << welded.status();
    EXPECT_NEAR(EstimateNoise(*welded), deviation, 0.2 * deviation + 1e-12);
  }
  EXPECT_EQ(EstimateNoise(*Weld(Box({0, 0, 0}, {1, 1, 1}))), 0);
}

// Corners are far from the middle of those around them, which is no noise.
TEST(WeldedSurfaceTest, TakesCornersOfManyBoxesForNoNoise) {
  const auto welded = Weld(testing::Placed(testing::Shelf(1.2, 0.018), 0.4, {3, 2, 1}));
  ASSERT_TRUE(welded.ok()) << welded.status();
  EXPECT_LT(EstimateNoise(*welded), 1e-9);
}

TEST(WeldedSurfaceTest, TakesRoundSurfacesForNoNoise) {
  mesh::SurfaceMesh ball = testing::Refined(Box({-1, -1, -1}, {1, 1, 1}), 0.15);
  ball.vertices.colwise().normalize();
  const auto welded = Weld(ball);
  ASSERT_TRUE(welded.ok()) << welded.status();
  EXPECT_LT(EstimateNoise(*welded), 1e-3);
}

TEST(WeldedSurfaceTest, RefusesWhatHasNoArea) {
  EXPECT_EQ(DetailOf(Weld({}).status()).field, "query");
  EXPECT_EQ(DetailOf(Weld(Box({0, 0, 0}, {1, 0, 0})).status()).field, "query");
}

}  // namespace
}  // namespace mortise::retrieval
