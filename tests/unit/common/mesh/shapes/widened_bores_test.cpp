// Bores that are no plain cylinders: slots and countersinks, and what divides a shape beside them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <vector>

#include "common/mesh/shapes/countersinks.h"
#include "common/mesh/shapes/shape_levels.h"
#include "common/mesh/shapes/slots.h"
#include "tests/unit/common/cad/stretch/bored_boards.h"
#include "tests/unit/common/cad/stretch/oblong.h"

namespace mortise::cad {
namespace {

using mesh::Countersink;
using mesh::DrawnShape;
using mesh::ShapeLevel;
using mesh::Slot;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// m from the middle, of the levels along an axis that divide a shape.
std::vector<double> DividingAlong(int axis, const DrawnShape& shape) {
  std::vector<double> places;
  for (const ShapeLevel& level : mesh::LevelsOf(shape)) {
    if (level.axis == axis && level.divides) places.push_back(level.fraction * shape.size[axis]);
  }
  return places;
}

void ExpectNear(const std::vector<double>& places, const std::vector<double>& expected) {
  ASSERT_EQ(places.size(), expected.size());
  for (std::size_t i = 0; i < places.size(); ++i) EXPECT_NEAR(places[i], expected[i], 1e-9);
}

TopoDS_Shape Less(const TopoDS_Shape& solid, const TopoDS_Shape& tool) {
  return BRepAlgoAPI_Cut(solid, tool).Shape();
}

TEST(Slots, AreTwoHalvesThatFaceEachOther) {
  const gp_Pnt from(-0.02, 0.004, -1), to(0.015, 0.004, -1);
  const DrawnShape shape = Drawn(Less(Board(kBlock), Oblong(from, to, 0.005, 2)), kBlock);
  const std::vector<Slot> slots = mesh::SlotsOf(mesh::RoundFacesOf(shape));
  ASSERT_THAT(slots, SizeIs(1));
  EXPECT_EQ(slots[0].axis, 2);
  EXPECT_EQ(slots[0].along, 0);
  EXPECT_LT((slots[0].middle - Eigen::Vector3d(-0.0025, 0.004, 0)).norm(), 1e-9);
  EXPECT_LT((slots[0].size - Eigen::Vector3d(0.045, 0.01, kBlock.z())).norm(), 1e-9);
  ExpectNear(DividingAlong(0, shape), {-0.025, 0.02});
  ExpectNear(DividingAlong(1, shape), {-0.001, 0.009});
}

TEST(Slots, AreOneEachInARow) {
  TopoDS_Shape board = Board(kBlock);
  for (const double x : {-0.03, 0.005}) {
    board = Less(board, Oblong(gp_Pnt(x, 0, -1), gp_Pnt(x + 0.02, 0, -1), 0.004, 2));
  }
  const std::vector<Slot> slots = mesh::SlotsOf(mesh::RoundFacesOf(Drawn(board, kBlock)));
  ASSERT_THAT(slots, SizeIs(2));
  for (const Slot& slot : slots) EXPECT_NEAR(slot.size.x(), 0.028, 1e-9);
}

TEST(Slots, AreNotNotchesInOppositeEdges) {
  TopoDS_Shape board = Board(kBlock);
  for (const double side : {-0.5, 0.5}) {
    board = Less(board, Upright(side * kBlock.x(), 0, -1, 1, 0.006));
  }
  EXPECT_THAT(mesh::SlotsOf(mesh::RoundFacesOf(Drawn(board, kBlock))), IsEmpty());
}

TEST(Countersinks, AreConesInAFlatFace) {
  const double top = kBlock.z() / 2;
  const TopoDS_Shape cone =
      BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0.01, 0.003, top - 0.004), gp_Dir(0, 0, 1)), 0.003, 0.008,
                           0.005)
          .Solid();
  const DrawnShape shape =
      Drawn(Less(Less(Board(kBlock), Upright(0.01, 0.003, -1, 1, 0.003)), cone), kBlock);
  const std::vector<Countersink> found = mesh::CountersinksOf(shape);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].axis, 2);
  EXPECT_NEAR(found[0].radius, 0.007, 1e-9);
  EXPECT_NEAR(found[0].depth, 0.004, 1e-9);
  EXPECT_LT((found[0].middle - Eigen::Vector3d(0.01, 0.003, top - 0.002)).norm(), 1e-9);
  // Beside the cone the board goes straight on; beside the bore it does not.
  ExpectNear(DividingAlong(0, shape), {0.003, 0.017});
}

// A bore whose side is level with the middle of another, where the kernel's triangles begin, would
// be stretched differently on either side of it.
TEST(Levels, DivideNoFaceAtItsTrianglesEnds) {
  const DrawnShape shape = Drawn(Less(Less(Board(kBlock), Upright(-0.02, -0.01, -1, 1, 0.008)),
                                      Upright(-0.02 + 0.005, 0.015, -1, 1, 0.005)),
                                 kBlock);
  ExpectNear(DividingAlong(0, shape), {-0.028, -0.01});
}

TEST(Countersinks, AreRoundedRims) {
  const TopoDS_Shape bored = Less(Board(kBlock), Upright(0.01, 0.003, -1, 1, 0.004));
  BRepFilletAPI_MakeFillet rounded(bored);
  for (TopExp_Explorer edge(bored, TopAbs_EDGE); edge.More(); edge.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(edge.Current()));
    if (curve.GetType() != GeomAbs_Circle || curve.Value(0).Z() < 0) continue;
    rounded.Add(0.002, TopoDS::Edge(edge.Current()));
    break;
  }
  const DrawnShape shape = Drawn(rounded.Shape(), kBlock);
  const std::vector<Countersink> found = mesh::CountersinksOf(shape);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_NEAR(found[0].radius, 0.006, 1e-9);
  EXPECT_NEAR(found[0].depth, 0.002, 1e-9);
  ExpectNear(DividingAlong(1, shape), {-0.003, 0.009});
}

TEST(Countersinks, AreNeitherBoresNorBosses) {
  EXPECT_THAT(mesh::CountersinksOf(Drawn(Bored(kBlock, kTwoBores), kBlock)), IsEmpty());
  const Eigen::Vector3d size(0.04, 0.04, 0.03);
  const TopoDS_Shape boss = BRepAlgoAPI_Fuse(
      BoxAt(-0.02, -0.02, -0.015, 0.04, 0.04, 0.02),
      BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, 0.005), gp_Dir(0, 0, 1)), 0.01, 0.006, 0.01)
          .Solid());
  EXPECT_THAT(mesh::CountersinksOf(Drawn(boss, size)), IsEmpty());
}

}  // namespace
}  // namespace mortise::cad
