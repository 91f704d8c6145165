// Shapes of surfaces as people have them. What solids become is tested with the CAD kernel
// (tests/unit/common/cad/stretch/drawn_shape_test.cpp).
#include "common/mesh/shapes/drawn_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/base/errors.h"
#include "common/mesh/shapes/countersinks.h"
#include "common/mesh/shapes/round_faces.h"
#include "common/mesh/shapes/shape_levels.h"
#include "tests/support/box_scenes.h"

namespace mortise::mesh {
namespace {

using testing::Box;
using testing::OpenBox;

SurfaceMesh SurfaceOf(const SceneComponent& component) {
  return {component.vertices, component.triangles};
}

absl::StatusOr<DrawnShape> Shape(const SurfaceMesh& surface) {
  return ShapeOfSurface(surface, surface.vertices.rowwise().minCoeff(),
                        surface.vertices.rowwise().maxCoeff());
}

TEST(ShapeOfSurface, TakesClosedOnesForSolids) {
  const auto shape = Shape(SurfaceOf(Box("", {1, 1, 1}, {1, 2, 3})));
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_TRUE(shape->is_solid);
  EXPECT_NEAR(shape->volume, 6, 1e-12);
}

TEST(ShapeOfSurface, TurnsOutwardsWhatIsInsideOut) {
  SurfaceMesh surface = SurfaceOf(Box("", {1, 1, 1}, {1, 2, 3}));
  surface.triangles.row(0).swap(surface.triangles.row(1));
  const auto shape = Shape(surface);
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_TRUE(shape->is_solid);
}

// Open, doubled, of two pieces: each as it is, stretched with its box.
TEST(ShapeOfSurface, TakesTheOthersAsTheyAre) {
  const SceneComponent open = OpenBox("", {0, 0, 0}, {1, 2, 3});
  Scene two;
  two.components = {Box("", {0, 0, 0}, {1, 1, 1}), Box("", {3, 0, 0}, {1, 1, 1})};
  Scene doubled;
  doubled.components = {open, open};
  for (const SceneComponent& component : {open, Joined(two), Joined(doubled)}) {
    const SurfaceMesh surface = SurfaceOf(component);
    const auto shape = Shape(surface);
    ASSERT_TRUE(shape.ok()) << shape.status();
    EXPECT_FALSE(shape->is_solid);
    EXPECT_GT(shape->volume, 0);
    EXPECT_EQ(shape->triangles, surface.triangles);
    const Eigen::Vector3d size = 2 * shape->size;
    const SurfaceMesh larger = SurfaceIn(*shape, BoxStretch(size));
    EXPECT_TRUE((larger.vertices.rowwise().maxCoeff() - larger.vertices.rowwise().minCoeff())
                    .isApprox(size));
    EXPECT_NEAR(VolumeIn(*shape, BoxStretch(size)), 8 * shape->volume, 1e-9 * shape->volume);
  }
}

TEST(ShapeOfSurface, GuessesTheVolumeOfWhatIsOpen) {
  const auto shape = Shape(SurfaceOf(OpenBox("", {5, 0, 0}, {1, 2, 3})));
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_NEAR(shape->volume, 5, 1e-9);  // five of six pyramids about the middle
}

TEST(ShapeOfSurface, MayBeFlatInABoxThatIsNot) {
  SurfaceMesh square;
  square.vertices = (Eigen::Matrix3Xd(3, 4) << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0).finished();
  square.triangles = (Eigen::Matrix3Xi(3, 2) << 0, 0, 1, 2, 2, 3).finished();
  const auto shape = ShapeOfSurface(square, {0, 0, -0.01}, {1, 1, 0.01});
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_FALSE(shape->is_solid);
  EXPECT_TRUE(shape->fractions.row(2).isZero());
  EXPECT_GT(shape->volume, 0);
  EXPECT_FALSE(Shape(square).ok());
}

TEST(ShapeOfSurface, HasNoBoresNorLevelsWhereItIsNoSolid) {
  const auto shape = Shape(SurfaceOf(OpenBox("", {0, 0, 0}, {1, 2, 3})));
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_TRUE(RoundFacesOf(*shape).empty());
  EXPECT_TRUE(CountersinksOf(*shape).empty());
  EXPECT_TRUE(LevelsOf(*shape).empty());
}

TEST(ShapeOfSurface, RefusesWhatHasNoPlace) {
  EXPECT_EQ(DetailOf(ShapeOfSurface({}, {0, 0, 0}, {1, 1, 1}).status()).field, "shape");
  for (const double place : {20e3, std::numeric_limits<double>::quiet_NaN()}) {
    SurfaceMesh surface = SurfaceOf(Box("", {0, 0, 0}, {1, 1, 1}));
    surface.vertices(1, 3) = place;
    EXPECT_TRUE(absl::IsInvalidArgument(Shape(surface).status())) << place;
  }
}

}  // namespace
}  // namespace mortise::mesh
