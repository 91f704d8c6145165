// Exact solids stretched in pieces between levels that divide their shapes.
#include <gtest/gtest.h>

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeWedge.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <gp_Circ.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Elips.hxx>
#include <map>
#include <numbers>
#include <random>

#include "common/cad/solid_box.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "common/cad/stretch/solid_shape.h"
#include "common/cad/stretch/solid_stretch.h"
#include "common/mesh/shapes/shape_levels.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/cad/stretch/oblong.h"
#include "tests/unit/common/cad/surface/fused_parts.h"

namespace mortise::cad {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.008;
constexpr double kThick = 0.018;

mesh::DrawnShape ShapeOf(const TopoDS_Shape& solid) {
  const SolidBox box = BoxOf(solid, Eigen::Matrix3d::Identity());
  auto shape =
      ShapeOfSolid(Named(solid, "part"), Eigen::Matrix3d::Identity(), box.minimum, box.maximum);
  EXPECT_TRUE(shape.ok()) << shape.status();
  return shape.ok() ? *std::move(shape) : mesh::DrawnShape();
}

TopoDS_Shape Less(const TopoDS_Shape& solid, const TopoDS_Shape& tool) {
  return BRepAlgoAPI_Cut(solid, tool).Shape();
}

// A stretch into a box of this size that puts what lies at `from`, m along an axis from the lower
// corner of the drawn box, at `to`.
mesh::BoxStretch Into(const mesh::DrawnShape& shape, const Eigen::Vector3d& size,
                      const std::array<std::map<double, double>, 3>& places) {
  mesh::BoxStretch stretch(size);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<Eigen::Index>(axis);
    for (const auto& [from, to] : places[axis]) {
      stretch.levels[axis].push_back({from / shape.size[index] - 0.5, to - size[index] / 2});
    }
  }
  return stretch;
}

// All levels that divide it as it was drawn, each of them put somewhere between its neighbours.
mesh::BoxStretch RandomStretch(const mesh::DrawnShape& shape, std::mt19937_64& random) {
  const auto factor = [&] { return std::uniform_real_distribution<double>(0.6, 1.8)(random); };
  std::array<std::vector<double>, 3> fractions;
  for (const mesh::ShapeLevel& level : mesh::LevelsOf(shape)) {
    if (level.divides) fractions[static_cast<std::size_t>(level.axis)].push_back(level.fraction);
  }
  mesh::BoxStretch stretch(shape.size);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double drawn = shape.size[static_cast<Eigen::Index>(axis)];
    double from = -0.5, size = 0;
    std::vector<double> places;
    for (const double fraction : fractions[axis]) {
      size += factor() * drawn * (fraction - from);
      from = fraction;
      places.push_back(size);
    }
    size += factor() * drawn * (0.5 - from);
    stretch.size[static_cast<Eigen::Index>(axis)] = size;
    for (std::size_t i = 0; i < places.size(); ++i) {
      stretch.levels[axis].push_back({fractions[axis][i], places[i] - size / 2});
    }
  }
  return stretch;
}

mesh::DrawnShape Divided(const mesh::DrawnShape& shape) {
  std::vector<mesh::ShapeLevel> dividing;
  for (const mesh::ShapeLevel& level : mesh::LevelsOf(shape)) {
    if (level.divides) dividing.push_back(level);
  }
  return mesh::DividedAt(shape, dividing);
}

double VolumeRead(const Solid& solid) {
  const auto bytes = WriteStep("part", {{solid}});
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  if (!bytes.ok()) return 0;
  const auto read = ReadStep(*bytes);
  EXPECT_TRUE(read.ok()) << read.status();
  double volume = 0;
  if (read.ok()) {
    for (const auto& product : read->products) {
      volume += product.solid ? product.solid->Volume() : 0;
    }
  }
  return volume;
}

int CountFaces(const TopoDS_Shape& shape) {
  int count = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) ++count;
  return count;
}

// By hand: the wood of the box but for a bore of 16 mm, which is where it was put, and round.
TEST(SolidsInPieces, KeepABoreRound) {
  const mesh::DrawnShape shape =
      ShapeOf(Less(BoxAt(0, 0, 0, 0.4, 0.3, kThick), Upright(0.1, 0.1, -1, 1, kRadius)));
  const mesh::BoxStretch stretch =
      Into(shape, {0.7, 0.25, kThick},
           {{{{0.092, 0.192}, {0.108, 0.208}}, {{0.092, 0.062}, {0.108, 0.078}}, {}}});
  ASSERT_OK_AND_ASSIGN(const Solid board, SolidOfShape(shape, stretch, "board"));
  const double volume = (0.7 * 0.25 - kPi * kRadius * kRadius) * kThick;
  EXPECT_NEAR(AccurateVolume(board.kernel().shape) / volume, 1, 1e-9);
  EXPECT_NEAR(VolumeRead(board) / volume, 1, 1e-6);
  EXPECT_EQ(CountFaces(board.kernel().shape), 7);
  int cylinders = 0;
  for (TopExp_Explorer face(board.kernel().shape, TopAbs_FACE); face.More(); face.Next()) {
    const BRepAdaptor_Surface surface(TopoDS::Face(face.Current()));
    if (surface.GetType() != GeomAbs_Cylinder) continue;
    ++cylinders;
    EXPECT_NEAR(surface.Cylinder().Radius(), kRadius, 1e-12);
    EXPECT_NEAR(surface.Cylinder().Location().X(), 0.2, 1e-12);
    EXPECT_NEAR(surface.Cylinder().Location().Y(), 0.07, 1e-12);
  }
  EXPECT_EQ(cylinders, 1);
}

// By hand: a rail of 40 × 100 mm whose tenons, 20 × 60 mm, stay 30 mm long.
TEST(SolidsInPieces, KeepTenons) {
  const mesh::DrawnShape shape = ShapeOf(
      BRepAlgoAPI_Fuse(BoxAt(0.03, 0, 0, 0.4, 0.04, 0.1), BoxAt(0, 0.01, 0.02, 0.46, 0.02, 0.06))
          .Shape());
  const mesh::BoxStretch stretch =
      Into(shape, {0.86, 0.04, 0.1}, {{{{0.03, 0.03}, {0.43, 0.83}}, {}, {}}});
  ASSERT_OK_AND_ASSIGN(const Solid rail, SolidOfShape(shape, stretch, "rail"));
  const double volume = 0.8 * 0.04 * 0.1 + 2 * 0.03 * 0.02 * 0.06;
  EXPECT_NEAR(AccurateVolume(rail.kernel().shape) / volume, 1, 1e-9);
  EXPECT_NEAR(VolumeRead(rail) / volume, 1, 1e-6);
}

struct Kind {
  std::string name;
  TopoDS_Shape (*draw)();
  int least_levels = 2;  // that divide it
};

TopoDS_Shape Plate() {
  TopoDS_Shape plate = BoxAt(0, 0, 0, 0.6, 0.3, kThick);
  plate = Less(plate, Upright(0.1, 0.1, -1, 1, 0.01));
  plate = Less(plate, Upright(0.1, 0.22, -1, 1, 0.006));
  plate = Less(plate, Upright(0.3, 0.1, -1, 1, 0.004));
  return Less(plate, Upright(0.5, 0.2, 0.008, 1, 0.015));
}
// A bore along z meets one along x, and the long edges are rounded: cylinders over all pieces.
TopoDS_Shape RoundedBlock() {
  const TopoDS_Shape block = BoxAt(0, 0, 0, 0.4, 0.06, 0.06);
  BRepFilletAPI_MakeFillet rounded(block);
  for (TopExp_Explorer found(block, TopAbs_EDGE); found.More(); found.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(found.Current());
    Bnd_Box box;
    BRepBndLib::Add(edge, box);
    if (box.CornerMax().X() - box.CornerMin().X() > 0.3) rounded.Add(0.006, edge);
  }
  const TopoDS_Shape along =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(-0.1, 0.03, 0.03), gp_Dir(1, 0, 0)), 0.006, 0.25)
          .Solid();
  return Less(Less(rounded.Shape(), Upright(0.1, 0.03, -1, 1, 0.01)), along);
}
TopoDS_Shape Counterbored() {
  const TopoDS_Shape board = BoxAt(0, 0, 0, 0.2, 0.15, 0.03);
  return Less(Less(board, Upright(0.06, 0.07, -1, 1, 0.005)), Upright(0.06, 0.07, 0.02, 1, 0.012));
}
// A slot right through, along x, and one of 8 mm depth along y.
TopoDS_Shape Slotted() {
  const TopoDS_Shape board = BoxAt(0, 0, 0, 0.3, 0.2, kThick);
  return Less(Less(board, Oblong(gp_Pnt(0.05, 0.06, -1), gp_Pnt(0.09, 0.06, -1), 0.006, 2)),
              Oblong(gp_Pnt(0.2, 0.08, 0.01), gp_Pnt(0.2, 0.12, 0.01), 0.004, 1));
}
// One bore is countersunk, the other has a rounded rim.
TopoDS_Shape Countersunk() {
  TopoDS_Shape board = BoxAt(0, 0, 0, 0.2, 0.15, kThick);
  const gp_Ax2 from(gp_Pnt(0.06, 0.05, kThick - 0.004), gp_Dir(0, 0, 1));
  board = Less(Less(board, Upright(0.06, 0.05, -1, 1, 0.004)),
               BRepPrimAPI_MakeCone(from, 0.004, 0.009, 0.005).Solid());
  board = Less(board, Upright(0.14, 0.1, -1, 1, 0.007));
  BRepFilletAPI_MakeFillet rounded(board);
  for (TopExp_Explorer found(board, TopAbs_EDGE); found.More(); found.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(found.Current()));
    const bool is_rim = curve.GetType() == GeomAbs_Circle && curve.Circle().Radius() > 0.0065 &&
                        curve.Circle().Location().X() > 0.1 && curve.Value(0).Z() > 0.01;
    if (!is_rim) continue;
    rounded.Add(0.002, TopoDS::Edge(found.Current()));
    break;
  }
  return rounded.Shape();
}
// A tube along x whose wall is bored at two places.
TopoDS_Shape BoredTube() {
  const auto along = [](double radius) {
    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0.03, 0.03), gp_Dir(1, 0, 0)), radius, 0.5)
        .Solid();
  };
  return Less(Less(Less(along(0.03), along(0.025)), Upright(0.1, 0.03, 0.03, 1, 0.006)),
              Upright(0.35, 0.03, 0.03, 1, 0.009));
}
// An elliptic bar, swept along x, with a blind bore that ends in half a ball; its surfaces as they
// are, and as splines.
TopoDS_Shape EllipticBar() {
  const gp_Elips outline(gp_Ax2(gp_Pnt(0, 0.04, 0.03), gp_Dir(1, 0, 0), gp_Dir(0, 1, 0)), 0.04,
                         0.03);
  const TopoDS_Wire wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(outline));
  const TopoDS_Shape bar =
      BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wire).Shape(), gp_Vec(0.5, 0, 0)).Shape();
  const TopoDS_Shape bit =
      BRepAlgoAPI_Fuse(Upright(0.2, 0.03, 0.03, 1, 0.006),
                       BRepPrimAPI_MakeSphere(gp_Pnt(0.2, 0.03, 0.03), 0.006).Solid())
          .Shape();
  return Less(bar, bit);
}
TopoDS_Shape SplinedBar() { return BRepBuilderAPI_NurbsConvert(EllipticBar(), true).Shape(); }

class SolidsInPieces : public ::testing::TestWithParam<Kind> {};

// Whatever is asked for: valid, of the volume that the surface encloses, read as written, and as
// large as its box.
TEST_P(SolidsInPieces, AreSound) {
  const mesh::DrawnShape drawn = ShapeOf(GetParam().draw());
  const mesh::DrawnShape shape = Divided(drawn);
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 6; ++trial) {
    SCOPED_TRACE(trial);
    const mesh::BoxStretch stretch = RandomStretch(drawn, random);
    int levels = 0;
    for (const auto& along : stretch.levels) levels += static_cast<int>(along.size());
    ASSERT_GE(levels, GetParam().least_levels);
    ASSERT_OK_AND_ASSIGN(const Solid solid, SolidOfShape(shape, stretch, "part"));
    const TopoDS_Shape& made = solid.kernel().shape;
    EXPECT_TRUE(BRepCheck_Analyzer(made).IsValid());
    const double volume = AccurateVolume(made);
    EXPECT_NEAR(mesh::VolumeIn(shape, stretch) / volume, 1, 1e-5);
    const SolidBox box = BoxOf(made, Eigen::Matrix3d::Identity());
    EXPECT_LT((box.maximum - stretch.size).norm(), 1e-7);
    EXPECT_LT(box.minimum.norm(), 1e-7);
    EXPECT_EQ(CountFaces(made), static_cast<int>(shape.face_names.size()));
    if (trial > 0) continue;
    EXPECT_NEAR(VolumeRead(solid) / volume, 1, 1e-6);
  }
}

// Turned first, and stretched along the axes that it then has.
TEST_P(SolidsInPieces, AreSoundWhenTurned) {
  const mesh::DrawnShape drawn = mesh::Turned(ShapeOf(GetParam().draw()), 1, 0);
  const mesh::DrawnShape shape = Divided(drawn);
  std::mt19937_64 random(3);
  const mesh::BoxStretch stretch = RandomStretch(drawn, random);
  ASSERT_OK_AND_ASSIGN(const Solid solid, SolidOfShape(shape, stretch, "part"));
  const double volume = AccurateVolume(solid.kernel().shape);
  EXPECT_NEAR(mesh::VolumeIn(shape, stretch) / volume, 1, 1e-5);
  EXPECT_NEAR(VolumeRead(solid) / volume, 1, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(AllKinds, SolidsInPieces,
                         ::testing::Values(Kind{"Plate", Plate, 11},
                                           Kind{"Counterbored", Counterbored, 5},
                                           Kind{"Slotted", Slotted, 9},
                                           Kind{"Countersunk", Countersunk, 9}),
                         [](const auto& kind) { return kind.param.name; });

struct Rod {
  std::string name;
  TopoDS_Shape (*draw)();
  std::vector<double> levels;  // m, along x, at the sides of its bores
  // The same solid as the kernel cuts it exactly, as it does not cut splines.
  TopoDS_Shape (*plain)() = draw;
};

class RodsInPieces : public ::testing::TestWithParam<Rod> {};

// What lies between two levels is stretched by itself, so that the volume is that of the slabs.
TEST_P(RodsInPieces, AreTheirSlabsStretched) {
  const TopoDS_Shape drawn = Named(GetParam().draw(), "rod").kernel().shape;
  const TopoDS_Shape plain = GetParam().plain();
  const SolidBox box = BoxOf(drawn, Eigen::Matrix3d::Identity());
  ASSERT_LT(box.minimum.norm(), 1e-7);
  mesh::DrawnShape shape;
  shape.size = box.maximum;
  std::vector<double> ends = GetParam().levels;
  ends.insert(ends.begin(), 0);
  ends.push_back(shape.size.x());
  std::vector<double> slabs;
  for (std::size_t i = 1; i < ends.size(); ++i) {
    const TopoDS_Shape slab = BoxAt(ends[i - 1], -1, -1, ends[i] - ends[i - 1], 3, 3);
    slabs.push_back(AccurateVolume(BRepAlgoAPI_Common(plain, slab).Shape()));
  }
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 4; ++trial) {
    SCOPED_TRACE(trial);
    const auto factor = [&] { return std::uniform_real_distribution<double>(0.6, 1.8)(random); };
    const double wide = factor(), high = factor();
    std::map<double, double> places;
    double place = 0, volume = 0;
    for (std::size_t i = 1; i < ends.size(); ++i) {
      const double along = factor();
      place += along * (ends[i] - ends[i - 1]);
      volume += along * wide * high * slabs[i - 1];
      if (i + 1 < ends.size()) places[ends[i]] = place;
    }
    const Eigen::Vector3d size(place, wide * shape.size.y(), high * shape.size.z());
    const StretchMap map(shape.size, Into(shape, size, {places, {}, {}}));
    const TopoDS_Shape stretched = StretchSolid(drawn, map, volume);
    ASSERT_FALSE(stretched.IsNull()) << WhyNotStretched(drawn, map);
    EXPECT_TRUE(BRepCheck_Analyzer(stretched).IsValid());
    EXPECT_NEAR(AccurateVolume(stretched) / volume, 1, 1e-7);
    const SolidBox into = BoxOf(stretched, Eigen::Matrix3d::Identity());
    EXPECT_LT((into.maximum - size).norm(), 1e-7);
    EXPECT_EQ(CountFaces(stretched), CountFaces(drawn));
    if (trial > 0) continue;
    EXPECT_NEAR(VolumeRead(Named(stretched, "rod")) / volume, 1, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(
    AllKinds, RodsInPieces,
    ::testing::Values(Rod{"RoundedBlock", RoundedBlock, {0.09, 0.11}},
                      Rod{"BoredTube", BoredTube, {0.094, 0.106, 0.341, 0.359}},
                      Rod{"EllipticBar", EllipticBar, {0.194, 0.206}},
                      Rod{"SplinedBar", SplinedBar, {0.194, 0.206}, EllipticBar}),
    [](const auto& rod) { return rod.param.name; });

// One end of a wedge is slanted, and a level would bend it.
TEST(SolidsInPieces, AreNoneWhereAFaceWouldBend) {
  const TopoDS_Shape wedge = BRepPrimAPI_MakeWedge(0.4, 0.1, 0.1, 0.2).Solid();
  mesh::DrawnShape shape;
  shape.size = {0.4, 0.1, 0.1};
  const StretchMap map(shape.size, Into(shape, {0.5, 0.1, 0.1}, {{{{0.3, 0.4}}, {}, {}}}));
  EXPECT_TRUE(StretchSolid(wedge, map, 0.0035).IsNull());
  EXPECT_NE(WhyNotStretched(wedge, map).find("of its 6 faces"), std::string::npos);
  EXPECT_NE(WhyNotStretched(wedge, map).find("level"), std::string::npos);
}

}  // namespace
}  // namespace mortise::cad
