// Round solids that were cut at any place, turned and stretched unevenly: they are the linear image
// of what was drawn, in boxes of the right size, and are read from STEP as they were written.
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepOffsetAPI_MakeThickSolid.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <Eigen/Geometry>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>
#include <gp_Elips.hxx>
#include <numbers>
#include <random>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "common/cad/solid_box.h"
#include "common/cad/solid_surface.h"
#include "common/cad/step/step_measure.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "common/cad/stretch/solid_shape.h"
#include "common/cad/stretch/solid_stretch.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/cad/step/step_samples.h"

namespace mortise::cad {
namespace {

constexpr double kPi = std::numbers::pi;

Solid SolidFrom(const TopoDS_Shape& shape) {
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = "round";
  kernel->shape = TopExp_Explorer(shape, TopAbs_SOLID).Current();
  for (TopExp_Explorer face(kernel->shape, TopAbs_FACE); face.More(); face.Next()) {
    kernel->face_names.push_back(absl::StrCat("face", kernel->faces.size()));
    kernel->faces.push_back(TopoDS::Face(face.Current()));
  }
  return Solid(std::move(kernel));
}

TopoDS_Shape Without(const TopoDS_Shape& solid, const TopoDS_Shape& tool) {
  return BRepAlgoAPI_Cut(solid, tool).Shape();
}

// All that lies farther than `distance` along a direction.
TopoDS_Shape Beyond(const gp_Dir& along, double distance) {
  const gp_Pnt at(along.XYZ() * distance);
  return BRepPrimAPI_MakeCylinder(gp_Ax2(at, along), 0.2, 0.2).Solid();
}

TopoDS_Shape Bore(const gp_Dir& along, const gp_XYZ& through, double radius) {
  const gp_Pnt from(through - along.XYZ() * 0.05);
  return BRepPrimAPI_MakeCylinder(gp_Ax2(from, along), radius, 0.1).Solid();
}

TopoDS_Shape Ball(double radius) { return BRepPrimAPI_MakeSphere(radius).Solid(); }

TopoDS_Shape HollowBall() { return Without(Ball(0.03), Ball(0.026)); }

TopoDS_Shape Cone() {
  return BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 0.03, 0.005, 0.06).Solid();
}

class Draws {
 public:
  explicit Draws(unsigned seed) : bits_(seed) {}

  // The same on every machine, as the library's distributions are not.
  double Between(double from, double to) { return from + (to - from) * bits_() / 4294967296.0; }

  gp_Dir Direction() {
    for (;;) {
      const gp_XYZ at(Between(-1, 1), Between(-1, 1), Between(-1, 1));
      if (at.Modulus() > 0.2 && at.Modulus() < 1) return gp_Dir(at);
    }
  }

  TopoDS_Shape Round(unsigned kind) {
    switch (kind % 5) {
      case 0:
        return Ball(0.02);
      case 1:
        return HollowBall();
      case 2:
        return Cone();
      case 3:
        return BRepPrimAPI_MakeTorus(0.015, Between(0.003, 0.007)).Solid();
      default:
        return BRepPrimAPI_MakeCylinder(0.02, Between(0.01, 0.06)).Solid();
    }
  }

 private:
  std::mt19937 bits_;
};

// Cut by a plane, bored, and turned.
TopoDS_Shape Sample(unsigned seed) {
  Draws draws(seed);
  TopoDS_Shape solid = draws.Round(seed);
  solid = Without(solid, Beyond(draws.Direction(), draws.Between(0, 0.012)));
  if (seed % 2 == 0) {
    solid = Without(solid, Bore(draws.Direction(), gp_XYZ(0, 0, draws.Between(0, 0.008)), 0.004));
  }
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), draws.Direction()), draws.Between(0, 6));
  return BRepBuilderAPI_Transform(solid, turn, Standard_True).Shape();
}

Eigen::Vector3d SizeOf(const TopoDS_Shape& shape,
                       const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity()) {
  const SolidBox box = BoxOf(shape, rotation);
  return box.maximum - box.minimum;
}

// The volume, m³, and whether it is valid, as the kernel's plain reader has it.
double VolumeRead(const std::string& bytes) {
  STEPControl_Reader reader;
  std::istringstream stream(bytes);
  EXPECT_EQ(reader.ReadStream("step", stream), IFSelect_RetDone);
  reader.TransferRoots();
  EXPECT_TRUE(BRepCheck_Analyzer(reader.OneShape()).IsValid());
  return AccurateVolume(reader.OneShape()) * 1e-9;
}

TEST(StretchedSolids, AreTheLinearImageOfWhatWasDrawn) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Solid solid = SolidFrom(Sample(seed));
    const TopoDS_Shape& drawn = solid.kernel().shape;
    ASSERT_TRUE(BRepCheck_Analyzer(drawn).IsValid()) << seed;
    Draws draws(seed + 100);
    const Eigen::Vector3d factors(draws.Between(0.5, 2), draws.Between(0.5, 2), 1);
    const TopoDS_Shape stretched = StretchSolid(drawn, StretchMap(factors), 0);
    ASSERT_FALSE(stretched.IsNull()) << seed;
    EXPECT_TRUE(BRepCheck_Analyzer(stretched).IsValid()) << seed;
    const double volume = solid.Volume() * factors.prod();
    EXPECT_NEAR(AccurateVolume(stretched), volume, 1e-9 * volume) << seed;
    // The corners of fine triangles lie on the surface: none is outside the box, and one is close
    // to each of its faces.
    SurfaceOptions fine;
    fine.deflection = 1e-4;
    fine.relative_deflection = 0;
    const auto surface = SurfaceOf(solid, fine);
    ASSERT_TRUE(surface.ok()) << surface.status();
    const Eigen::Matrix3Xd image = factors.asDiagonal() * surface->vertices;
    const SolidBox box = BoxOf(stretched, Eigen::Matrix3d::Identity());
    const Eigen::Vector3d below = image.rowwise().minCoeff() - box.minimum;
    const Eigen::Vector3d above = box.maximum - image.rowwise().maxCoeff();
    EXPECT_GT(std::min(below.minCoeff(), above.minCoeff()), -1e-7) << seed;
    EXPECT_LT(std::max(below.maxCoeff(), above.maxCoeff()), 2.5e-4) << seed;
  }
}

// Those that refused to be stretched once: their volumes are known.
TEST(StretchedSolids, AreNotRefusedWhereTheyAreCutBesideTheirAxis) {
  const auto cut_ball = [](double radius, double at) {
    return kPi * (2 * std::pow(radius, 3) / 3 + radius * radius * at - std::pow(at, 3) / 3);
  };
  const TopoDS_Shape bowl = Without(HollowBall(), Beyond(gp_Dir(0, 1, 0), 0.005));
  const Solid solid = SolidFrom(bowl);
  EXPECT_NEAR(solid.Volume(), cut_ball(0.03, 0.005) - cut_ball(0.026, 0.005), 1e-12);
  for (const TopoDS_Shape& shape : {bowl, Without(Cone(), Beyond(gp_Dir(0, 1, 0), 0.008))}) {
    const auto written = WriteStep("cut", {{SolidFrom(shape)}});
    ASSERT_TRUE(written.ok()) << written.status();
    const auto read = ReadStep(*written);
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_EQ(read->parts.size(), 1U);
    EXPECT_TRUE(read->parts[0].faults.empty());
    const double volume = SolidFrom(shape).Volume();
    EXPECT_NEAR(read->parts[0].volume, volume, 1e-9 * volume);
  }
}

// An elliptic bar, hollowed out by what is everywhere 3 mm from its outside.
TopoDS_Shape HollowBar() {
  const gp_Elips outline(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 0.04, 0.03);
  const TopoDS_Wire wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(outline));
  BRepPrimAPI_MakePrism bar(BRepBuilderAPI_MakeFace(wire).Shape(), gp_Vec(0, 0, 0.1));
  TopTools_ListOfShape open;
  open.Append(bar.LastShape());
  BRepOffsetAPI_MakeThickSolid hollow;
  hollow.MakeThickSolidByJoin(bar.Shape(), open, -0.003, 1e-6);
  return hollow.Shape();
}

TEST(StretchedSolids, MayHaveOffsetSurfaces) {
  const Solid solid = SolidFrom(HollowBar());
  const TopoDS_Shape& drawn = solid.kernel().shape;
  const SolidBox box = BoxOf(drawn, Eigen::Matrix3d::Identity());
  ASSERT_OK_AND_ASSIGN(const mesh::DrawnShape shape,
                       ShapeOfSolid(solid, Eigen::Matrix3d::Identity(), box.minimum, box.maximum));
  const Eigen::Vector3d factors(1.3, 0.8, 2);
  ASSERT_OK_AND_ASSIGN(const Solid stretched,
                       SolidOfShape(shape, factors.cwiseProduct(shape.size), "bar"));
  const double volume = AccurateVolume(drawn) * factors.prod();
  EXPECT_NEAR(AccurateVolume(stretched.kernel().shape), volume, 1e-6 * volume);
  EXPECT_TRUE(BRepCheck_Analyzer(stretched.kernel().shape).IsValid());
  EXPECT_LT((SizeOf(stretched.kernel().shape) - factors.cwiseProduct(shape.size)).norm(), 1e-8);
}

TEST(StretchedSolids, AreReadAsTheyWereWritten) {
  // Of a bore through a ball's seam readers take the wrong side, unless the ball is cut open.
  for (const TopoDS_Shape& shape :
       {Sample(3), Without(Ball(0.02), Bore(gp_Dir(1, 0, 0), gp_XYZ(0, 0, 0), 0.006))}) {
    StepPart part;
    const Solid solid = SolidFrom(shape);
    SolidMeasurer(solid.kernel().shape).Measure(Eigen::Isometry3d::Identity(), part);
    const auto drawn = ShapeOfSolid(solid, Eigen::Matrix3d::Identity(), part.minimum, part.maximum);
    ASSERT_TRUE(drawn.ok()) << drawn.status();
    const Eigen::Vector3d factors(2, 1, 1.1);
    const auto stretched = SolidOfShape(*drawn, drawn->size.cwiseProduct(factors), "stretched");
    ASSERT_TRUE(stretched.ok()) << stretched.status();
    const auto written = WriteStep("stretched", {{*stretched}});
    ASSERT_TRUE(written.ok()) << written.status();
    const double volume = solid.Volume() * factors.prod();
    EXPECT_NEAR(VolumeRead(*written), volume, 1e-6 * volume);
  }
}

TEST(SolidBox, EndsWhereTheSolidDoes) {
  constexpr double kExact = 1e-9;
  EXPECT_NEAR(SizeOf(Without(Ball(0.02), Beyond(gp_Dir(0, 1, 0), 0.015))).y(), 0.035, kExact);
  const TopoDS_Shape bored = Without(Ball(0.02), Bore(gp_Dir(1, 0, 0), gp_XYZ(0, 0, 0), 0.006));
  EXPECT_NEAR(SizeOf(bored).x(), 2 * std::sqrt(0.02 * 0.02 - 0.006 * 0.006), kExact);
  EXPECT_NEAR(SizeOf(bored).z(), 0.04, kExact);
  EXPECT_NEAR(SizeOf(Without(Cone(), Beyond(gp_Dir(0, 1, 0), 0.008))).y(), 0.038, kExact);
  Draws draws(7);
  for (int i = 0; i < 10; ++i) {
    const gp_Dir axis = draws.Direction();
    const gp_Ax2 place(gp_Pnt(0.1, 0.2, -0.3), axis);
    const Eigen::Vector3d along(axis.X(), axis.Y(), axis.Z());
    const Eigen::Vector3d across = (1 - along.array().square()).sqrt();
    const Eigen::Vector3d rod = SizeOf(BRepPrimAPI_MakeCylinder(place, 0.02, 0.1).Solid());
    EXPECT_LT((rod - (0.04 * across + 0.1 * along.cwiseAbs())).norm(), kExact);
    const Eigen::Vector3d ring = SizeOf(BRepPrimAPI_MakeTorus(place, 0.03, 0.004).Solid());
    EXPECT_LT((ring - 0.06 * across - Eigen::Vector3d::Constant(0.008)).norm(), kExact);
    // A ball that is stretched, then turned.
    const Eigen::Vector3d factors(draws.Between(0.5, 2), draws.Between(0.5, 2), 1);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(draws.Between(0, 6), along).toRotationMatrix();
    const TopoDS_Shape ball =
        StretchSolid(BRepPrimAPI_MakeSphere(place, 0.02).Solid(), StretchMap(factors), 0);
    ASSERT_FALSE(ball.IsNull());
    const Eigen::Matrix3d map = turn * factors.asDiagonal();
    EXPECT_LT((SizeOf(ball, turn) - 0.04 * map.rowwise().norm()).norm(), kExact);
  }
}

}  // namespace
}  // namespace mortise::cad
