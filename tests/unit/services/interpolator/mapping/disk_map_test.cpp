#include "services/interpolator/mapping/disk_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/patches.h"

namespace mortise::interpolator {
namespace {

double SignedArea(const DiskPatch& patch, const Eigen::Matrix2Xd& at, Eigen::Index t) {
  const Eigen::Vector2d a = at.col(patch.triangles(0, t));
  const Eigen::Vector2d ab = at.col(patch.triangles(1, t)) - a;
  const Eigen::Vector2d ac = at.col(patch.triangles(2, t)) - a;
  return (ab.x() * ac.y() - ab.y() * ac.x()) / 2;
}

TEST(DiskMapTest, TurnsNoTriangleOverAndFillsTheRegion) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    const DiskPatch patch = RandomPatch(random, 3 + static_cast<int>(seed) / 2, 0.4);
    const Eigen::Matrix2Xd circle = OnCircle(patch);
    ASSERT_OK_AND_ASSIGN(const DiskMap map, DiskMap::Create(patch, circle));
    double sum = 0, region = 0;
    for (Eigen::Index t = 0; t < patch.triangles.cols(); ++t) {
      EXPECT_GT(SignedArea(patch, map.positions(), t), 0) << "seed " << seed;
      sum += SignedArea(patch, map.positions(), t);
    }
    for (Eigen::Index i = 0; i < circle.cols(); ++i) {
      const Eigen::Vector2d a = circle.col(i), b = circle.col((i + 1) % circle.cols());
      region += (a.x() * b.y() - a.y() * b.x()) / 2;
    }
    EXPECT_NEAR(sum, region, 1e-12);
  }
}

// Mean values have linear precision: a plane patch whose boundary stays where it is stays.
TEST(DiskMapTest, LeavesPlaneConvexPatchesAsTheyAre) {
  std::mt19937 random(7);
  DiskPatch patch = RandomPatch(random, 9, 0);
  const Eigen::Matrix2Xd circle = OnCircle(patch);
  // A disk of the plane z = 2: the flat image of some patch.
  ASSERT_OK_AND_ASSIGN(const DiskMap first, DiskMap::Create(patch, circle));
  patch.vertices.topRows(2) = first.positions();
  patch.vertices.row(2).setConstant(2);
  ASSERT_OK_AND_ASSIGN(const DiskMap second, DiskMap::Create(patch, circle));
  EXPECT_LT((second.positions() - first.positions()).cwiseAbs().maxCoeff(), 1e-12);
}

// A fan around the top of a cone: each spoke has the same weight by symmetry, so the top goes to
// the middle of a regular polygon whatever the cone's height.
TEST(DiskMapTest, TakesTheTopOfAConeToTheMiddle) {
  for (const double height : {0.0, 0.3, 20.0}) {
    DiskPatch cone;
    const int sides = 7;
    cone.vertices.resize(3, sides + 1);
    cone.triangles.resize(3, sides);
    for (int k = 0; k < sides; ++k) {
      cone.vertices.col(k) << std::cos(2 * M_PI * k / sides), std::sin(2 * M_PI * k / sides), 0;
      cone.triangles.col(k) << k, (k + 1) % sides, sides;
      cone.boundary.push_back(k);
    }
    cone.vertices.col(sides) << 0, 0, height;
    ASSERT_OK_AND_ASSIGN(const DiskMap map, DiskMap::Create(cone, OnCircle(cone)));
    EXPECT_LT(map.positions().col(sides).norm(), 1e-14);
  }
}

TEST(DiskMapTest, LocatesPointsFromAnyTriangle) {
  std::mt19937 random(3);
  const DiskPatch patch = RandomPatch(random, 12, 0.3);
  ASSERT_OK_AND_ASSIGN(const DiskMap map, DiskMap::Create(patch, OnCircle(patch)));
  std::uniform_real_distribution<double> angle(0, 2 * M_PI), radius(0, 0.97);
  std::uniform_int_distribution<int> hint(0, static_cast<int>(patch.triangles.cols()) - 1);
  for (int i = 0; i < 500; ++i) {
    const double a = angle(random), r = radius(random);
    const Eigen::Vector2d point(r * std::cos(a), r * std::sin(a));
    const TrianglePlace place = map.Locate(point, hint(random));
    Eigen::Vector2d found = Eigen::Vector2d::Zero();
    for (int k = 0; k < 3; ++k) {
      found += place.barycentric[k] * map.positions().col(patch.triangles(k, place.triangle));
    }
    EXPECT_GE(place.barycentric.minCoeff(), 0);
    EXPECT_LT((found - point).norm(), 1e-12);
  }
  // A point beyond the boundary is taken to it.
  EXPECT_NEAR(map.Locate({1 + 1e-14, 0}).barycentric.sum(), 1, 1e-14);
}

TEST(DiskMapTest, RefusesWhatIsNoDisk) {
  std::mt19937 random(1);
  const DiskPatch patch = RandomPatch(random, 5, 0.2);
  const auto field_of = [](const DiskPatch& of, const Eigen::Matrix2Xd& boundary) {
    const auto map = DiskMap::Create(of, boundary);
    EXPECT_EQ(map.status().code(), absl::StatusCode::kInvalidArgument) << map.status();
    return DetailOf(map.status()).field;
  };
  DiskPatch holed = patch;  // a triangle within is missing
  for (Eigen::Index t = 0; t < patch.triangles.cols(); ++t) {
    bool is_inner = true;
    for (int k = 0; k < 3; ++k) {
      const int vertex = patch.triangles(k, t);
      is_inner = is_inner && std::find(patch.boundary.begin(), patch.boundary.end(), vertex) ==
                                 patch.boundary.end();
    }
    if (is_inner) holed.triangles.col(t) = holed.triangles.col(holed.triangles.cols() - 1);
    if (is_inner) break;
  }
  holed.triangles.conservativeResize(Eigen::NoChange, holed.triangles.cols() - 1);
  EXPECT_EQ(field_of(holed, OnCircle(holed)), "patch");
  DiskPatch pinched = patch;  // two vertices are at one place
  pinched.vertices.col(patch.triangles(0, 4)) = pinched.vertices.col(patch.triangles(1, 4));
  EXPECT_EQ(field_of(pinched, OnCircle(pinched)), "patch");
  EXPECT_EQ(field_of(patch, OnCircle(patch).leftCols(3)), "boundary");
}

}  // namespace
}  // namespace mortise::interpolator
