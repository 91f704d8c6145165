// Where shapes turn back, and where they can be stretched by pieces.
#include "common/mesh/shapes/shape_levels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <array>
#include <map>
#include <utility>

#include "common/mesh/shapes/round_faces.h"
#include "common/mesh/surface_check.h"
#include "tests/unit/common/cad/stretch/bored_boards.h"

namespace mortise::cad {
namespace {

using mesh::BoxStretch;
using mesh::DrawnShape;
using mesh::RoundFace;
using mesh::ShapeLevel;
using ::testing::Pair;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

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

}  // namespace
}  // namespace mortise::cad
