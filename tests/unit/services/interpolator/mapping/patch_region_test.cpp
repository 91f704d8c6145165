#include "services/interpolator/mapping/patch_region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

double Turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - b).y() - (b - a).y() * (c - b).x();
}

void ExpectStrictlyConvex(const Eigen::Matrix2Xd& boundary) {
  const Eigen::Index count = boundary.cols();
  double turned = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d a = boundary.col(i), b = boundary.col((i + 1) % count);
    const Eigen::Vector2d c = boundary.col((i + 2) % count);
    EXPECT_GT(Turn(a, b, c), 0);
    turned += std::atan2(Turn(a, b, c), (b - a).dot(c - b));
  }
  EXPECT_NEAR(turned, 2 * M_PI, 1e-9);
}

TEST(PatchRegionTest, IsStrictlyConvex) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(0.02, 1);
    std::vector<BoundarySide> sides(1 + seed % 7);
    double sum = 0;
    for (BoundarySide& side : sides) {
      side.share = noise(random);
      sum += side.share;
      side.places = {0};
      for (unsigned i = 0; i < 2 + seed % 5; ++i) {
        side.places.push_back(side.places.back() + noise(random));
      }
      for (double& place : side.places) place /= side.places.back() + 0.1;
    }
    for (BoundarySide& side : sides) side.share /= sum;
    ExpectStrictlyConvex(RegionBoundary(sides));
  }
}

// The sides of a box become sides of a quadrangle that is nearly a rectangle.
TEST(PatchRegionTest, HasTheCornersOfThePatch) {
  const BlockMesh box = MakeBlockMesh(BoxShape({0.3, 0.2, 0.1}), {});
  ASSERT_OK_AND_ASSIGN(const PatchLayout layout,
                       BuildPatchLayout(box.marked, box.marked, {.large_patch = 1}));
  ASSERT_EQ(layout.walks.size(), 6U);
  for (std::size_t patch = 0; patch < 6; ++patch) {
    const Eigen::Matrix2Xd boundary = RegionOf(layout, patch);
    ExpectStrictlyConvex(boundary);
    int corners = 0;
    const Eigen::Index count = boundary.cols();
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Vector2d in = boundary.col((i + 1) % count) - boundary.col(i);
      const Eigen::Vector2d out = boundary.col((i + 2) % count) - boundary.col((i + 1) % count);
      if (in.normalized().dot(out.normalized()) < std::cos(1.0)) ++corners;
    }
    EXPECT_EQ(corners, 4);
  }
}

TEST(PatchRegionTest, IsRoundWithoutCorners) {
  const BlockMesh rod = MakeBlockMesh(CylinderShape(0.05, 0.2), {.along = 8, .across = 8});
  ASSERT_OK_AND_ASSIGN(const PatchLayout layout,
                       BuildPatchLayout(rod.marked, rod.marked, {.large_patch = 1}));
  int round = 0;
  for (std::size_t patch = 0; patch < layout.walks.size(); ++patch) {
    const Eigen::Matrix2Xd boundary = RegionOf(layout, patch);
    ExpectStrictlyConvex(boundary);
    if ((boundary.colwise().norm().array() - 1).abs().maxCoeff() < 1e-12) ++round;
  }
  EXPECT_EQ(round, 2);  // the ends; the wall is cut open along a line with four corners
}

}  // namespace
}  // namespace mortise::interpolator
