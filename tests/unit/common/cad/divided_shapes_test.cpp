// Shapes of solids whose bores, steps and grooves are known: where they turn back, what can be
// stretched by itself there, and what comes of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include "common/cad/solid_shape.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/round_faces.h"
#include "common/mesh/shape_levels.h"
#include "common/mesh/shared_edges.h"
#include "common/mesh/surface_check.h"
#include "tests/unit/common/cad/fused_parts.h"

namespace mortise::cad {
namespace {

using mesh::BoxStretch;
using mesh::DrawnShape;
using mesh::LevelPlace;
using mesh::RoundFace;
using mesh::ShapeLevel;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;
constexpr double kPi = std::numbers::pi;

// A cylinder to be cut away: along an axis, through a point of the axis.
struct Bore {
  int axis = 2;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // m, from the middle of the board
  double radius = 0;
  double length = 10;
};

TopoDS_Shape ToolOf(const Bore& bore) {
  Eigen::Vector3d from = bore.middle;
  from[bore.axis] -= bore.length / 2;
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(bore.axis);
  return BRepPrimAPI_MakeCylinder(
             gp_Ax2(gp_Pnt(from.x(), from.y(), from.z()), gp_Dir(along.x(), along.y(), along.z())),
             bore.radius, bore.length)
      .Solid();
}

TopoDS_Shape Board(const Eigen::Vector3d& size) {
  return BoxAt(-size.x() / 2, -size.y() / 2, -size.z() / 2, size.x(), size.y(), size.z());
}

TopoDS_Shape Bored(const Eigen::Vector3d& size, const std::vector<Bore>& bores) {
  TopoDS_Shape board = Board(size);
  for (const Bore& bore : bores) board = BRepAlgoAPI_Cut(board, ToolOf(bore)).Shape();
  return board;
}

// `size`: of the solid's box, in the middle of which is the origin.
DrawnShape Drawn(const TopoDS_Shape& solid, const Eigen::Vector3d& size) {
  auto shape =
      ShapeOfSolid(Named(solid, "solid"), Eigen::Matrix3d::Identity(), -size / 2, size / 2);
  EXPECT_TRUE(shape.ok()) << shape.status();
  return shape.ok() ? *std::move(shape) : DrawnShape();
}

// By axis: of each level its height, nm rounded, and whether it divides the shape.
using Heights = std::map<long, bool>;
std::array<Heights, 3> HeightsOf(const DrawnShape& shape) {
  std::array<Heights, 3> heights;
  for (const ShapeLevel& level : mesh::LevelsOf(shape)) {
    const double height = level.fraction * shape.size[level.axis];
    heights[static_cast<std::size_t>(level.axis)][std::lround(1e9 * height)] = level.divides;
  }
  return heights;
}

std::vector<ShapeLevel> DividingLevels(const DrawnShape& shape) {
  std::vector<ShapeLevel> levels = mesh::LevelsOf(shape);
  std::erase_if(levels, [](const ShapeLevel& level) { return !level.divides; });
  return levels;
}

// Each piece between levels becomes a third to three times as long.
BoxStretch RandomStretch(const DrawnShape& shape, const std::vector<ShapeLevel>& levels,
                         std::mt19937_64& random) {
  std::uniform_real_distribution<double> exponent(-1, 1);
  BoxStretch stretch(shape.size);
  for (const ShapeLevel& level : levels) {
    stretch.levels[static_cast<std::size_t>(level.axis)].push_back({level.fraction, 0});
  }
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<LevelPlace>& places = stretch.levels[static_cast<std::size_t>(axis)];
    double below = -0.5, length = 0;
    for (std::size_t i = 0; i <= places.size(); ++i) {
      const double above = i < places.size() ? places[i].fraction : 0.5;
      length += (above - below) * shape.size[axis] * std::pow(3, exponent(random));
      below = above;
      if (i < places.size()) places[i].place = length;
    }
    for (LevelPlace& place : places) place.place -= length / 2;
    stretch.size[axis] = length;
  }
  return stretch;
}

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

// Triangles whose normals point elsewhere than they did: folds.
int CountFolds(const DrawnShape& shape, const BoxStretch& stretch) {
  const Eigen::Matrix3Xd before =
      mesh::TriangleNormals(mesh::SurfaceIn(shape, shape.size).vertices, shape.triangles);
  const Eigen::Matrix3Xd after =
      mesh::TriangleNormals(mesh::SurfaceIn(shape, stretch).vertices, shape.triangles);
  int folds = 0;
  for (Eigen::Index t = 0; t < before.cols(); ++t) {
    for (int axis = 0; axis < 3; ++axis) {
      folds += before(axis, t) * after(axis, t) < -1e-6;
    }
  }
  return folds;
}

void ExpectNoneCrosses(const DrawnShape& shape, const std::vector<ShapeLevel>& levels) {
  for (const ShapeLevel& level : levels) {
    const double same = mesh::kSameLevel / shape.size[level.axis];
    for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
      const Eigen::Vector3i corners = shape.triangles.col(t);
      const Eigen::RowVector3d heights = shape.fractions.row(level.axis)(corners);
      EXPECT_FALSE(heights.minCoeff() < level.fraction - same &&
                   heights.maxCoeff() > level.fraction + same)
          << "triangle " << t << ", axis " << level.axis << " at " << level.fraction;
    }
  }
}

const Eigen::Vector3d kBlock(0.1, 0.06, 0.04);
// Across each other without meeting: one upright, one along.
const std::vector<Bore> kTwoBores = {{2, {-0.02, -0.015, 0}, 0.0093}, {0, {0, 0.015, 0}, 0.0061}};

TEST(RoundFaces, AreTheBoresOfABoard) {
  const std::vector<RoundFace> faces = mesh::RoundFacesOf(Drawn(Bored(kBlock, kTwoBores), kBlock));
  ASSERT_THAT(faces, SizeIs(2));
  for (std::size_t i = 0; i < 2; ++i) {
    const Bore& bore = kTwoBores[1 - i];
    const RoundFace& face = faces[i];
    EXPECT_EQ(face.axis, bore.axis);
    EXPECT_LT((face.middle - bore.middle).norm(), 1e-12);
    EXPECT_NEAR(face.radius, bore.radius, 1e-12);
    EXPECT_NEAR(face.length, kBlock[bore.axis], 1e-12);
    EXPECT_TRUE(face.is_hollow);
    EXPECT_TRUE(face.is_whole);
  }
}

TEST(RoundFaces, AreWholeHoweverManyFacesTheyAreDrawnIn) {
  TopoDS_Shape board = Board(kBlock);
  for (const double side : {1.0, -1.0}) {
    const gp_Ax2 axis(gp_Pnt(0.01, 0.003, -1), gp_Dir(0, 0, 1), gp_Dir(0.6, side * 0.8, 0));
    board = BRepAlgoAPI_Cut(board, BRepPrimAPI_MakeCylinder(axis, 0.008, 2, kPi).Solid()).Shape();
    board = BRepAlgoAPI_Cut(
                board, BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0.01, 0.003, -1), gp_Dir(0, 0, 1),
                                                       gp_Dir(-0.6, -side * 0.8, 0)),
                                                0.008, 2, kPi)
                           .Solid())
                .Shape();
  }
  const DrawnShape shape = Drawn(board, kBlock);
  const std::vector<RoundFace> faces = mesh::RoundFacesOf(shape);
  ASSERT_THAT(faces, SizeIs(1));
  std::set<int> drawn;
  for (const int t : faces[0].triangles) drawn.insert(shape.triangle_face(t));
  EXPECT_GE(drawn.size(), 2U);
  EXPECT_TRUE(faces[0].is_whole);
  EXPECT_LT((faces[0].middle - Eigen::Vector3d(0.01, 0.003, 0)).norm(), 1e-11);
}

// From both sides of a board, in line, with wood between.
TEST(RoundFaces, AreTwoWithAGapBetween) {
  const DrawnShape shape =
      Drawn(Bored(kBlock, {{2, {0.01, 0, -0.02}, 0.007, 0.02}, {2, {0.01, 0, 0.02}, 0.007, 0.03}}),
            kBlock);
  const std::vector<RoundFace> faces = mesh::RoundFacesOf(shape);
  ASSERT_THAT(faces, SizeIs(2));
  EXPECT_NEAR(faces[0].middle.z(), -0.015, 1e-12);
  EXPECT_NEAR(faces[0].length, 0.01, 1e-12);
  EXPECT_NEAR(faces[1].middle.z(), 0.0125, 1e-12);
  EXPECT_NEAR(faces[1].length, 0.015, 1e-12);
  EXPECT_TRUE(faces[0].is_whole && faces[1].is_whole);
}

// The kernel knows the edge between two bores only within its tolerance.
TEST(RoundFaces, AreBoresThatMeet) {
  const std::vector<Bore> bores = {{2, {-0.02, 0, 0}, 0.01}, {0, {0, 0.002, 0}, 0.006}};
  const std::vector<RoundFace> faces = mesh::RoundFacesOf(Drawn(Bored(kBlock, bores), kBlock));
  ASSERT_THAT(faces, SizeIs(3));  // that along x is in two parts
  for (const RoundFace& face : faces) {
    const Bore& bore = bores[face.axis == 2 ? 0 : 1];
    EXPECT_NEAR(face.radius, bore.radius, 1e-9);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == face.axis) continue;
      EXPECT_NEAR(face.middle[axis], bore.middle[axis], 1e-9);
    }
    EXPECT_TRUE(face.is_hollow && face.is_whole);
  }
}

TEST(RoundFaces, AreNotSlantedOrTapered) {
  const TopoDS_Shape slanted =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, -0.3, -1), gp_Dir(0, 0.3, 1)), 0.006, 3).Solid();
  EXPECT_THAT(mesh::RoundFacesOf(Drawn(BRepAlgoAPI_Cut(Board(kBlock), slanted).Shape(), kBlock)),
              IsEmpty());
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 0), 0.012).Solid();
  EXPECT_THAT(mesh::RoundFacesOf(Drawn(BRepAlgoAPI_Cut(Board(kBlock), ball).Shape(), kBlock)),
              IsEmpty());
}

// In nm, by hand. The kernel draws the bore with an odd number of chords, so that on one side none
// reaches as far as it does.
TEST(DivisionOfShapes, IsAtTheSidesOfBores) {
  const DrawnShape shape = Drawn(Bored(kBlock, kTwoBores), kBlock);
  const std::vector<RoundFace> faces = mesh::RoundFacesOf(shape);
  ASSERT_THAT(faces, SizeIs(2));
  double furthest = 0;
  for (const int t : faces[1].triangles) {
    for (int k = 0; k < 3; ++k) {
      furthest = std::min(furthest, 0.1 * shape.fractions(0, shape.triangles(k, t)));
    }
  }
  EXPECT_GT(furthest, -0.0293 + 1e-5);
  const std::array<Heights, 3> heights = HeightsOf(shape);
  EXPECT_THAT(heights[0], UnorderedElementsAre(Pair(-29'300'000, true), Pair(-10'700'000, true)));
  EXPECT_THAT(heights[1], UnorderedElementsAre(Pair(-24'300'000, true), Pair(-5'700'000, true),
                                               Pair(8'900'000, true), Pair(21'100'000, true)));
  EXPECT_THAT(heights[2], UnorderedElementsAre(Pair(-6'100'000, true), Pair(6'100'000, true)));
}

// A narrow bore that goes on into a wide one cannot become wider without bending that.
TEST(DivisionOfShapes, IsNotWithinWhatIsRound) {
  const DrawnShape shape =
      Drawn(Bored(kBlock, {{2, {-0.02, 0, 0}, 0.006}, {2, {-0.02, 0, 0.02}, 0.011, 0.03}}), kBlock);
  const std::array<Heights, 3> heights = HeightsOf(shape);
  EXPECT_THAT(heights[0], UnorderedElementsAre(Pair(-31'000'000, true), Pair(-26'000'000, false),
                                               Pair(-14'000'000, false), Pair(-9'000'000, true)));
  EXPECT_THAT(heights[1], UnorderedElementsAre(Pair(-11'000'000, true), Pair(-6'000'000, false),
                                               Pair(6'000'000, false), Pair(11'000'000, true)));
  EXPECT_THAT(heights[2], UnorderedElementsAre(Pair(5'000'000, true)));
}

// Where a thin bore runs into a thick one of another direction, their edge is slanted all along.
TEST(DivisionOfShapes, IsNotWhereBoresMeet) {
  const DrawnShape shape =
      Drawn(Bored(kBlock, {{2, {-0.02, 0, 0}, 0.01}, {0, {0, 0.002, 0}, 0.006}}), kBlock);
  const std::array<Heights, 3> heights = HeightsOf(shape);
  EXPECT_THAT(heights[1], UnorderedElementsAre(Pair(-10'000'000, true), Pair(-4'000'000, false),
                                               Pair(8'000'000, false), Pair(10'000'000, true)));
}

TEST(DivisionOfShapes, IsAtShouldersOfTenons) {
  const TopoDS_Shape rail = BRepAlgoAPI_Fuse(BoxAt(-0.15, -0.01, -0.03, 0.3, 0.02, 0.06),
                                             BoxAt(-0.18, -0.004, -0.02, 0.36, 0.008, 0.04))
                                .Shape();
  const std::array<Heights, 3> heights = HeightsOf(Drawn(rail, {0.36, 0.02, 0.06}));
  EXPECT_THAT(heights[0], UnorderedElementsAre(Pair(-150'000'000, true), Pair(150'000'000, true)));
  EXPECT_THAT(heights[1], UnorderedElementsAre(Pair(-4'000'000, true), Pair(4'000'000, true)));
  EXPECT_THAT(heights[2], UnorderedElementsAre(Pair(-20'000'000, true), Pair(20'000'000, true)));
}

// A step under a sloping roof: stretched by itself along x, what is under it would bend the roof.
TEST(DivisionOfShapes, IsNotUnderSlopes) {
  BRepBuilderAPI_MakePolygon outline;
  for (const auto& [x, z] : {std::pair(-0.1, 0.0), std::pair(-0.03, 0.0), std::pair(-0.03, -0.02),
                             std::pair(0.1, -0.02), std::pair(0.1, 0.02), std::pair(-0.1, 0.01)}) {
    outline.Add(gp_Pnt(x, -0.02, z));
  }
  outline.Close();
  const TopoDS_Shape roof =
      BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), gp_Vec(0, 0.04, 0))
          .Shape();
  const std::array<Heights, 3> heights = HeightsOf(Drawn(roof, {0.2, 0.04, 0.04}));
  EXPECT_THAT(heights[0], UnorderedElementsAre(Pair(-30'000'000, false)));
  EXPECT_THAT(heights[2], UnorderedElementsAre(Pair(0, true)));
}

// A round groove ends where it meets the edge of the board: as wide as it is.
TEST(DivisionOfShapes, IsAtTheEdgesOfHalfBores) {
  const Bore groove{1, {0.01, 0, 0.02}, 0.0093};
  const DrawnShape shape = Drawn(Bored(kBlock, {groove}), kBlock);
  const std::vector<RoundFace> faces = mesh::RoundFacesOf(shape);
  ASSERT_THAT(faces, SizeIs(1));
  EXPECT_FALSE(faces[0].is_whole);
  EXPECT_TRUE(faces[0].reaches[2][0]);
  EXPECT_FALSE(faces[0].reaches[2][1]);
  const std::array<Heights, 3> heights = HeightsOf(shape);
  EXPECT_THAT(heights[0], UnorderedElementsAre(Pair(700'000, true), Pair(19'300'000, true)));
  EXPECT_THAT(heights[2], UnorderedElementsAre(Pair(10'700'000, true)));
}

// Boards with bores along all axes, that do not meet: each is found where it was made, and a level
// divides unless it lies within another bore's width.
TEST(DivisionOfShapes, IsWhatRandomBoresSay) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  for (int trial = 0; trial < 12; ++trial) {
    std::vector<Bore> bores;
    const Eigen::Vector3d size(0.3 + 0.1 * share(random), 0.2, 0.16);
    // One bore in each third along y, whatever its axis, but for those along y.
    for (int i = 0; i < 3; ++i) {
      Bore bore;
      bore.axis = 2 * (random() % 2);
      bore.radius = 0.01 + 0.015 * (share(random) + 0.5);
      bore.middle = size.cwiseProduct(Eigen::Vector3d(0.7 * share(random), 0, 0.6 * share(random)));
      bore.middle.y() = (i - 1) * 0.06 + 0.008 * share(random);
      bore.middle[bore.axis] = 0;
      bores.push_back(bore);
    }
    const DrawnShape shape = Drawn(Bored(size, bores), size);
    EXPECT_THAT(mesh::RoundFacesOf(shape), SizeIs(3));
    std::array<Heights, 3> expected;
    for (const Bore& bore : bores) {
      for (int axis = 0; axis < 3; ++axis) {
        if (axis == bore.axis) continue;
        for (const double end : {-1, 1}) {
          const double height = bore.middle[axis] + end * bore.radius;
          const bool divides = std::none_of(bores.begin(), bores.end(), [&](const Bore& other) {
            return other.axis != axis &&
                   std::abs(height - other.middle[axis]) < other.radius - 1e-3 * other.radius;
          });
          expected[static_cast<std::size_t>(axis)][std::lround(1e9 * height)] = divides;
        }
      }
    }
    EXPECT_EQ(HeightsOf(shape), expected) << trial;
    const std::vector<ShapeLevel> levels = DividingLevels(shape);
    const DrawnShape divided = mesh::DividedAt(shape, levels);
    const BoxStretch stretch = RandomStretch(shape, levels, random);
    EXPECT_TRUE(mesh::IsWatertight(mesh::SurfaceIn(divided, stretch))) << trial;
    EXPECT_EQ(CountFolds(divided, stretch), 0) << trial;
  }
}

// Whatever the stretch: closed, no fold, and the volume that a board with elliptic bores has.
TEST(StretchInPieces, IsExactForBoredBoards) {
  const DrawnShape shape = Drawn(Bored(kBlock, kTwoBores), kBlock);
  const std::vector<ShapeLevel> levels = DividingLevels(shape);
  const DrawnShape divided = mesh::DividedAt(shape, levels);
  ExpectNoneCrosses(divided, levels);
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

}  // namespace
}  // namespace mortise::cad
