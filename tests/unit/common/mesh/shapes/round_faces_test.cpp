// Which cylinders a shape has, however they are drawn.
#include "common/mesh/shapes/round_faces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepPrimAPI_MakeSphere.hxx>
#include <numbers>
#include <set>

#include "tests/unit/common/cad/stretch/bored_boards.h"

namespace mortise::cad {
namespace {

using mesh::DrawnShape;
using mesh::RoundFace;
using ::testing::IsEmpty;
using ::testing::SizeIs;
constexpr double kPi = std::numbers::pi;

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

// Along an edge of a board, a quarter of a bore: it reaches furthest into the board in two ways.
TEST(RoundFaces, SayWhereTheyReachFurthest) {
  const std::vector<RoundFace> faces =
      mesh::RoundFacesOf(Drawn(Bored(kBlock, {{1, {0.05, 0, 0.02}, 0.013}}), kBlock));
  ASSERT_THAT(faces, SizeIs(1));
  const std::array<std::array<bool, 2>, 3> reaches = {
      {{true, false}, {false, false}, {true, false}}};
  EXPECT_EQ(faces[0].reaches, reaches);
  EXPECT_FALSE(faces[0].is_whole);
  EXPECT_LT((faces[0].middle - Eigen::Vector3d(0.05, 0, 0.02)).norm(), 1e-10);
}

TEST(RoundFaces, OfPinsAreNotHollow) {
  const TopoDS_Shape pin = ToolOf({1, Eigen::Vector3d::Zero(), 0.007, 0.05});
  const std::vector<RoundFace> faces = mesh::RoundFacesOf(Drawn(pin, {0.014, 0.05, 0.014}));
  ASSERT_THAT(faces, SizeIs(1));
  EXPECT_EQ(faces[0].axis, 1);
  EXPECT_FALSE(faces[0].is_hollow);
  EXPECT_TRUE(faces[0].is_whole);
  EXPECT_NEAR(faces[0].radius, 0.007, 1e-11);
}

}  // namespace
}  // namespace mortise::cad
