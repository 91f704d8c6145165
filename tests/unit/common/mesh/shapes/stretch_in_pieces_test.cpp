// Shapes stretched in pieces: closed, without folds, and of the volume that they then have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <numbers>

#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "tests/unit/common/cad/stretch/bored_boards.h"

namespace mortise::cad {
namespace {

using mesh::BoxStretch;
using mesh::DrawnShape;
using mesh::LevelPlace;
using mesh::ShapeLevel;
using ::testing::IsEmpty;
using ::testing::SizeIs;
constexpr double kPi = std::numbers::pi;

// m, how long what reached from one height to another along an axis becomes.
double Stretched(const DrawnShape& shape, const BoxStretch& stretch, int axis, double from,
                 double to) {
  return stretch.PlaceOf(axis, to / shape.size[axis]) -
         stretch.PlaceOf(axis, from / shape.size[axis]);
}

// m³ of a bore through the whole board, whose sides are at levels: an ellipse, then.
double VolumeOfBore(const DrawnShape& shape, const BoxStretch& stretch, const Bore& bore) {
  double volume = kPi / 4 * stretch.size[bore.axis];
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == bore.axis) continue;
    volume *= Stretched(shape, stretch, axis, bore.middle[axis] - bore.radius,
                        bore.middle[axis] + bore.radius);
  }
  return volume;
}

// Triangles that reach across a level.
int CountAcross(const DrawnShape& shape, const std::vector<ShapeLevel>& levels) {
  int count = 0;
  for (const ShapeLevel& level : levels) {
    const double same = mesh::kOnPlane / shape.size[level.axis];
    for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
      const Eigen::Vector3i corners = shape.triangles.col(t);
      const Eigen::RowVector3d heights = shape.fractions.row(level.axis)(corners);
      count +=
          heights.minCoeff() < level.fraction - same && heights.maxCoeff() > level.fraction + same;
    }
  }
  return count;
}

// Whatever the stretch: closed, no fold, and the volume that a board with elliptic bores has.
TEST(StretchInPieces, IsExactForBoredBoards) {
  const DrawnShape shape = Drawn(Bored(kBlock, kTwoBores), kBlock);
  const std::vector<ShapeLevel> levels = DividingLevels(shape);
  const DrawnShape divided = mesh::DividedAt(shape, levels);
  EXPECT_EQ(CountAcross(divided, levels), 0);
  EXPECT_EQ(divided.fractions.leftCols(shape.fractions.cols()), shape.fractions);
  EXPECT_NEAR(mesh::VolumeIn(divided, shape.size), shape.volume, 0);
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 20; ++trial) {
    const BoxStretch stretch = RandomStretch(shape, levels, random);
    const mesh::SurfaceMesh surface = mesh::SurfaceIn(divided, stretch);
    EXPECT_THAT(mesh::CheckSurface(surface), IsEmpty());
    EXPECT_EQ(CountFolds(divided, stretch), 0);
    double volume = stretch.size.prod();
    for (const Bore& bore : kTwoBores) volume -= VolumeOfBore(shape, stretch, bore);
    EXPECT_NEAR(mesh::VolumeIn(divided, stretch), volume, 1e-9 * volume);
  }
}

// The same triangles, not divided, lie over one another when what is beside a bore shrinks.
TEST(StretchInPieces, FoldsWhatIsNotDivided) {
  const DrawnShape shape = Drawn(Bored(kBlock, kTwoBores), kBlock);
  const std::vector<ShapeLevel> levels = DividingLevels(shape);
  const DrawnShape divided = mesh::DividedAt(shape, levels);
  std::mt19937_64 random(9);
  int folds = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const BoxStretch stretch = RandomStretch(shape, levels, random);
    folds += CountFolds(shape, stretch);
    EXPECT_EQ(CountFolds(divided, stretch), 0);
  }
  EXPECT_GT(folds, 0);
}

// Bores as wide as drawn in a board of twice the length: analytic, and as exactly drawn.
TEST(StretchInPieces, LeavesBoresAsTheyWere) {
  const Eigen::Vector3d size(0.4, 0.12, 0.024);
  const std::vector<Bore> bores = {{2, {-0.1, 0, 0}, 0.0149}, {2, {0.1, 0, 0}, 0.0149}};
  const DrawnShape shape = Drawn(Bored(size, bores), size);
  const std::vector<ShapeLevel> levels = DividingLevels(shape);
  const DrawnShape divided = mesh::DividedAt(shape, levels);
  BoxStretch stretch(Eigen::Vector3d(0.8, 0.24, 0.024));
  for (const ShapeLevel& level : levels) {
    const double height = level.fraction * size[level.axis];
    const double moved = level.axis == 0 ? std::copysign(0.15, height) : 0;
    stretch.levels[static_cast<std::size_t>(level.axis)].push_back(
        {level.fraction, height + moved});
  }
  const double volume = stretch.size.prod() - 2 * kPi * 0.0149 * 0.0149 * 0.024;
  EXPECT_NEAR(mesh::VolumeIn(divided, stretch), volume, 1e-9 * volume);
  EXPECT_NEAR(mesh::DeflectionIn(divided, stretch), shape.deflection, 1e-12);
  // In proportion they would be twice as wide.
  EXPECT_NEAR(mesh::DeflectionIn(shape, stretch.size), 2 * shape.deflection, 1e-12);
  // One of them twice as long, along the board.
  stretch.levels[0][0].place -= 2 * 0.0149;
  EXPECT_NEAR(mesh::DeflectionIn(divided, stretch), 2 * shape.deflection, 1e-9);
}

TEST(StretchInPieces, IsExactForGroovesAndPins) {
  const Bore groove{1, {0.01, 0, 0.02}, 0.0093};
  const DrawnShape grooved = Drawn(Bored(kBlock, {groove}), kBlock);
  const Eigen::Vector3d size(0.1, 0.06, 0.05);
  const TopoDS_Shape pin = BRepAlgoAPI_Fuse(BoxAt(-0.05, -0.03, -0.025, 0.1, 0.06, 0.02),
                                            ToolOf({2, {-0.02, 0, 0.005}, 0.0103, 0.04}))
                               .Shape();
  const DrawnShape pinned = Drawn(pin, size);
  std::mt19937_64 random(13);
  for (int trial = 0; trial < 10; ++trial) {
    {
      const std::vector<ShapeLevel> levels = DividingLevels(grooved);
      const BoxStretch stretch = RandomStretch(grooved, levels, random);
      const double half = kPi / 4 * stretch.size.y() *
                          Stretched(grooved, stretch, 0, 0.0007, 0.0193) *
                          Stretched(grooved, stretch, 2, 0.0107, 0.02);
      const double volume = stretch.size.prod() - half;
      EXPECT_NEAR(mesh::VolumeIn(mesh::DividedAt(grooved, levels), stretch), volume, 1e-9 * volume);
    }
    const std::vector<ShapeLevel> levels = DividingLevels(pinned);
    const BoxStretch stretch = RandomStretch(pinned, levels, random);
    const double board =
        stretch.size.x() * stretch.size.y() * Stretched(pinned, stretch, 2, -0.025, -0.005);
    const double round = kPi / 4 * Stretched(pinned, stretch, 0, -0.0303, -0.0097) *
                         Stretched(pinned, stretch, 1, -0.0103, 0.0103) *
                         Stretched(pinned, stretch, 2, -0.005, 0.025);
    EXPECT_NEAR(mesh::VolumeIn(mesh::DividedAt(pinned, levels), stretch), board + round,
                1e-9 * (board + round));
  }
}

// A hollow ball is exact as long as it stays as it is, and else within a share of what its
// triangles miss.
TEST(StretchInPieces, KeepsBallsAndEstimatesEllipsoids) {
  const double r = 0.0113;
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(-0.02, 0, 0), r).Solid();
  const DrawnShape shape = Drawn(BRepAlgoAPI_Cut(Board(kBlock), ball).Shape(), kBlock);
  const std::vector<ShapeLevel> levels = DividingLevels(shape);
  ASSERT_THAT(levels, SizeIs(6));
  const DrawnShape divided = mesh::DividedAt(shape, levels);
  const double hollow = 4 * kPi / 3 * r * r * r;
  BoxStretch stretch(Eigen::Vector3d(2 * kBlock));
  for (const ShapeLevel& level : levels) {
    stretch.levels[static_cast<std::size_t>(level.axis)].push_back(
        {level.fraction, level.fraction * kBlock[level.axis]});
  }
  double volume = stretch.size.prod() - hollow;
  EXPECT_NEAR(mesh::VolumeIn(divided, stretch), volume, 1e-9 * volume);
  const double missed =
      mesh::ComputeMassProperties(mesh::SurfaceIn(shape, shape.size)).volume - shape.volume;
  for (LevelPlace& level : stretch.levels[1]) level.place *= 2;
  volume = stretch.size.prod() - 2 * hollow;
  EXPECT_NEAR(mesh::VolumeIn(divided, stretch), volume, 0.1 * missed);
}

// All places as drawn: whatever the shape, the volume that was measured.
TEST(StretchInPieces, KeepsTheDrawnVolumeAsItIs) {
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(0.02, 0, 0), 0.011).Solid();
  const TopoDS_Shape rail = BRepAlgoAPI_Fuse(Board({0.3, 0.02, 0.06}), Board({0.36, 0.008, 0.04}));
  for (const auto& [solid, size] :
       {std::pair(BRepAlgoAPI_Cut(Bored(kBlock, kTwoBores), ball).Shape(), kBlock),
        std::pair(rail, Eigen::Vector3d(0.36, 0.02, 0.06))}) {
    const DrawnShape shape = Drawn(solid, size);
    const std::vector<ShapeLevel> levels = DividingLevels(shape);
    BoxStretch stretch(size);
    for (const ShapeLevel& level : levels) {
      stretch.levels[static_cast<std::size_t>(level.axis)].push_back(
          {level.fraction, level.fraction * size[level.axis]});
    }
    ASSERT_FALSE(stretch.IsInProportion());
    EXPECT_NEAR(mesh::VolumeIn(mesh::DividedAt(shape, levels), stretch), shape.volume,
                1e-12 * shape.volume);
  }
}

// Of boxes end to end, by hand.
TEST(StretchInPieces, IsExactForTenons) {
  const Eigen::Vector3d size(0.36, 0.02, 0.06);
  const DrawnShape shape =
      Drawn(BRepAlgoAPI_Fuse(Board({0.3, 0.02, 0.06}), Board({0.36, 0.008, 0.04})).Shape(), size);
  const std::vector<ShapeLevel> levels = DividingLevels(shape);
  const DrawnShape divided = mesh::DividedAt(shape, levels);
  std::mt19937_64 random(17);
  for (int trial = 0; trial < 10; ++trial) {
    const BoxStretch stretch = RandomStretch(shape, levels, random);
    const double rail = Stretched(shape, stretch, 0, -0.15, 0.15);
    const double volume = rail * stretch.size.y() * stretch.size.z() +
                          (stretch.size.x() - rail) * Stretched(shape, stretch, 1, -0.004, 0.004) *
                              Stretched(shape, stretch, 2, -0.02, 0.02);
    EXPECT_NEAR(mesh::VolumeIn(divided, stretch), volume, 1e-12 * volume);
    EXPECT_THAT(mesh::CheckSurface(mesh::SurfaceIn(divided, stretch)), IsEmpty());
    EXPECT_EQ(mesh::DeflectionIn(divided, stretch), 0);
  }
}

}  // namespace
}  // namespace mortise::cad
