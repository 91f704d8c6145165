// Shapes cut at levels, and the maps that are linear between them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "common/mesh/mass_properties.h"
#include "common/mesh/shapes/box_stretch.h"
#include "common/mesh/shapes/round_faces.h"
#include "common/mesh/shapes/shape_levels.h"
#include "common/mesh/surface_check.h"
#include "tests/unit/common/mesh/round_solids.h"

namespace mortise::mesh {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

DrawnShape ShapeOf(const SurfaceMesh& surface) {
  auto shape = ShapeOfMesh(surface);
  EXPECT_TRUE(shape.ok()) << shape.status();
  return shape.ok() ? *std::move(shape) : DrawnShape();
}

// About z, `sides` chords round; inside and outside are round.
SurfaceMesh Washer(double outer, double inner, double height, int sides) {
  return ClosedGrid(sides, 4, [&](double angle, double corner) {
    const int k = static_cast<int>(std::lround(corner / (std::numbers::pi / 2)));
    const double radius = k == 0 || k == 3 ? outer : inner;
    return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), k < 2 ? height : 0);
  });
}

std::vector<SurfaceMesh> Surfaces() {
  return {Torus(0.1, 0.03, 17), Sphere(0.05, 9), Cylinder(0.02, 0.3, 11),
          Washer(0.05, 0.02, 0.01, 13),
          Rotated(Washer(0.05, 0.02, 0.01, 13),
                  Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).matrix())};
}

// By axis and then fraction; some where vertices are, some almost there, some hardly apart.
std::vector<ShapeLevel> RandomLevels(const DrawnShape& shape, std::mt19937_64& random) {
  std::uniform_real_distribution<double> fraction(-0.5, 0.5);
  std::uniform_int_distribution<Eigen::Index> vertex(0, shape.fractions.cols() - 1);
  std::vector<ShapeLevel> levels;
  for (int axis = 0; axis < 3; ++axis) {
    const double nearly = kOnPlane / 3 / shape.size[axis];
    for (int i = 0; i < 2; ++i) {
      const double level = fraction(random), at = shape.fractions(axis, vertex(random));
      for (const double one : {level, level + nearly, at, at + nearly}) {
        if (std::abs(one) < 0.499) levels.push_back({axis, one});
      }
    }
  }
  std::sort(levels.begin(), levels.end(), [](const ShapeLevel& a, const ShapeLevel& b) {
    return std::pair(a.axis, a.fraction) < std::pair(b.axis, b.fraction);
  });
  return levels;
}

// Triangles that reach across a level.
int CountAcross(const DrawnShape& shape, const std::vector<ShapeLevel>& levels) {
  int count = 0;
  for (const ShapeLevel& level : levels) {
    const double same = kOnPlane / shape.size[level.axis];
    for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
      const Eigen::Vector3i corners = shape.triangles.col(t);
      const Eigen::RowVector3d heights = shape.fractions.row(level.axis)(corners);
      count +=
          heights.minCoeff() < level.fraction - same && heights.maxCoeff() > level.fraction + same;
    }
  }
  return count;
}

// Vertices from `first` on that lie exactly at none of the levels.
int CountOffLevels(const DrawnShape& shape, Eigen::Index first,
                   const std::vector<ShapeLevel>& levels) {
  int count = 0;
  for (Eigen::Index k = first; k < shape.fractions.cols(); ++k) {
    count += std::none_of(levels.begin(), levels.end(), [&](const ShapeLevel& level) {
      return shape.fractions(level.axis, k) == level.fraction;
    });
  }
  return count;
}

// m², of each face.
std::vector<double> AreasOf(const DrawnShape& shape) {
  std::vector<double> areas(shape.face_names.size(), 0);
  const SurfaceMesh surface = SurfaceIn(shape, shape.size);
  for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t));
    areas[static_cast<std::size_t>(shape.triangle_face(t))] += (b - a).cross(c - a).norm() / 2;
  }
  return areas;
}

TEST(DividedShape, StaysTheClosedSurfaceThatItWas) {
  std::mt19937_64 random(3);
  for (const SurfaceMesh& surface : Surfaces()) {
    const DrawnShape shape = ShapeOf(surface);
    const std::vector<double> areas = AreasOf(shape);
    for (int trial = 0; trial < 3; ++trial) {
      const std::vector<ShapeLevel> levels = RandomLevels(shape, random);
      const DrawnShape divided = DividedAt(shape, levels);
      EXPECT_GT(divided.triangles.cols(), shape.triangles.cols());
      EXPECT_EQ(CountAcross(divided, levels), 0);
      EXPECT_TRUE(IsWatertight(SurfaceIn(divided, shape.size)));
      EXPECT_EQ(divided.fractions.leftCols(shape.fractions.cols()), shape.fractions);
      EXPECT_NEAR(ComputeMassProperties(SurfaceIn(divided, shape.size)).volume, shape.volume,
                  1e-12 * shape.volume);
      const std::vector<double> after = AreasOf(divided);
      ASSERT_EQ(after.size(), areas.size());
      for (std::size_t face = 0; face < areas.size(); ++face) {
        EXPECT_NEAR(after[face], areas[face], 1e-12);
      }
      EXPECT_EQ(CountOffLevels(divided, shape.fractions.cols(), levels), 0);
      // Once is enough.
      EXPECT_EQ(DividedAt(divided, levels).triangles, divided.triangles);
    }
  }
}

TEST(DividedShape, IsTheSameWithoutLevelsThatCrossIt) {
  const DrawnShape shape = ShapeOf(Torus(0.1, 0.03, 17));
  EXPECT_EQ(DividedAt(shape, {}).triangles, shape.triangles);
  EXPECT_EQ(DividedAt(shape, {{0, 0.5}, {1, -0.5}, {2, 7}}).triangles, shape.triangles);
}

// Of an odd number of chords, one bulges at the side away from the first. There the level is where
// the circle reaches.
TEST(DividedShape, KnowsTheBoreOfAWasher) {
  const double inner = 0.02;
  const DrawnShape shape = ShapeOf(Washer(0.05, inner, 0.01, 25));
  const std::vector<RoundFace> faces = RoundFacesOf(shape);
  ASSERT_THAT(faces, SizeIs(2));
  const RoundFace& bore = faces[0].is_hollow ? faces[0] : faces[1];
  EXPECT_NEAR(bore.radius, inner, 1e-12);
  EXPECT_NEAR(bore.length, 0.01, 1e-12);
  EXPECT_TRUE(bore.is_whole);
  std::vector<double> heights;
  for (const ShapeLevel& level : LevelsOf(shape)) {
    if (level.axis != 1) continue;
    heights.push_back(level.fraction * shape.size.y());
    // The outside would bend.
    EXPECT_EQ(level.divides, std::abs(heights.back()) > 0.04);
  }
  // The box ends where the triangles do, short of where the outside would.
  EXPECT_THAT(heights, ::testing::Pointwise(::testing::DoubleNear(1e-12), {-inner, inner}));
}

// Six flat sides are none, nor is a ball.
TEST(DividedShape, TakesFewFlatSidesForWhatTheyAre) {
  EXPECT_THAT(RoundFacesOf(ShapeOf(Cylinder(0.02, 0.1, 6))), IsEmpty());
  EXPECT_THAT(RoundFacesOf(ShapeOf(Cylinder(0.02, 0.1, 4))), IsEmpty());
  EXPECT_THAT(RoundFacesOf(ShapeOf(Sphere(0.02, 12))), IsEmpty());
  EXPECT_THAT(RoundFacesOf(ShapeOf(Torus(0.1, 0.03, 17))), IsEmpty());
}

TEST(DividedShape, TurnsWithItsLevels) {
  const DrawnShape shape = ShapeOf(Moved(Washer(0.05, 0.02, 0.01, 13), {1, 2, 3}));
  const DrawnShape turned = Turned(shape, 1, 0);  // x becomes y, z becomes x
  const std::vector<ShapeLevel> levels = LevelsOf(shape), after = LevelsOf(turned);
  ASSERT_EQ(levels.size(), after.size());
  for (const ShapeLevel& level : levels) {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    at[level.axis] = level.fraction;
    at = turned.turn * at;
    EXPECT_TRUE(std::any_of(after.begin(), after.end(), [&](const ShapeLevel& other) {
      return std::abs(at[other.axis]) > 0 && std::abs(at[other.axis] - other.fraction) < 1e-9 &&
             other.divides == level.divides;
    }));
  }
}

BoxStretch InThreePieces() {
  BoxStretch stretch(Eigen::Vector3d(2, 3, 4));
  stretch.levels[0] = {{-0.25, -0.9}, {0.25, 0.1}};
  stretch.levels[2] = {{0.1, 1}};
  return stretch;
}

TEST(BoxStretch, IsLinearBetweenLevels) {
  const BoxStretch stretch = InThreePieces();
  EXPECT_FALSE(stretch.IsInProportion());
  EXPECT_TRUE(stretch.IsInProportion(1));
  for (const auto& [axis, fraction, place] : {std::tuple(0, -0.5, -1.0),
                                              {0, -0.25, -0.9},
                                              {0, 0.0, -0.4},
                                              {0, 0.25, 0.1},
                                              {0, 0.375, 0.55},
                                              {0, 0.5, 1.0},
                                              {1, 0.2, 0.6},
                                              {2, -0.2, -0.5},
                                              {2, 0.3, 1.5}}) {
    EXPECT_NEAR(stretch.PlaceOf(axis, fraction), place, 1e-15) << axis << " at " << fraction;
  }
  EXPECT_NEAR(stretch.SlopeAt(0, -0.3), 0.4, 1e-15);
  EXPECT_NEAR(stretch.SlopeAt(0, 0), 2, 1e-15);
  EXPECT_NEAR(stretch.SlopeAt(0, 0.3), 3.6, 1e-14);
  EXPECT_NEAR(stretch.SlopeAt(1, 0.3), 3, 1e-15);
}

TEST(BoxStretch, TurnsWithTheShape) {
  const BoxStretch stretch = InThreePieces();
  Eigen::Matrix3d turn;  // x becomes z, backwards
  turn << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  const BoxStretch turned = stretch.Turned(turn);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> fraction(-0.5, 0.5);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d at(fraction(random), fraction(random), fraction(random));
    const Eigen::Vector3d there = turn * at;
    const auto place = [](const BoxStretch& one, const Eigen::Vector3d& of) {
      return Eigen::Vector3d(one.PlaceOf(0, of[0]), one.PlaceOf(1, of[1]), one.PlaceOf(2, of[2]));
    };
    EXPECT_LT((turn * place(stretch, at) - place(turned, there)).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace mortise::mesh
