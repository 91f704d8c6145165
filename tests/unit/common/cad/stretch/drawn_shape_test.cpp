// Shapes that stretch with their boxes: triangles and exact surfaces agree at any size, planes stay
// planes and cylinders cylinders where they can, and surfaces that bound no solid are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <gp_Ax1.hxx>
#include <map>
#include <numbers>
#include <random>

#include "common/cad/step/step_assembly_json.h"
#include "common/cad/step/step_measure.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "common/cad/stretch/solid_shape.h"
#include "common/cad/stretch/solid_stretch.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "tests/unit/common/cad/step/step_samples.h"

namespace mortise::cad {
namespace {

using ::testing::HasSubstr;
constexpr double kPi = std::numbers::pi;

Solid SolidFrom(const TopoDS_Shape& shape, const std::string& name) {
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = name;
  kernel->shape = TopExp_Explorer(shape, TopAbs_SOLID).Current();
  return Solid(std::move(kernel));
}

// A board of 400 × 120 × 24 mm with two bores of 30 mm through its thickness.
Solid BoredBoard() {
  TopoDS_Shape board = BRepPrimAPI_MakeBox(0.4, 0.12, 0.024).Solid();
  for (const double x : {0.1, 0.3}) {
    const gp_Ax2 axis(gp_Pnt(x, 0.06, -0.01), gp_Dir(0, 0, 1));
    board = BRepAlgoAPI_Cut(board, BRepPrimAPI_MakeCylinder(axis, 0.015, 0.05).Solid()).Shape();
  }
  return SolidFrom(board, "bored board");
}

// A leg about z with cylinders and cones.
Solid TurnedLeg() {
  BRepBuilderAPI_MakePolygon profile;
  for (const auto& [r, z] : {std::pair(0.0, 0.0),
                             {0.012, 0.0},
                             {0.02, 0.2},
                             {0.03, 0.25},
                             {0.02, 0.3},
                             {0.02, 0.4},
                             {0.0, 0.4}}) {
    profile.Add(gp_Pnt(r, 0, z));
  }
  profile.Close();
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(profile.Wire()).Face();
  return SolidFrom(BRepPrimAPI_MakeRevol(face, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape(),
                   "turned leg");
}

mesh::DrawnShape Drawn(const Solid& solid,
                       const Eigen::Matrix3d& rotation = Eigen::Matrix3d::Identity()) {
  StepPart part;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  placement.linear() = rotation;
  SolidMeasurer(solid.kernel().shape).Measure(placement, part);
  auto shape = ShapeOfSolid(solid, rotation, part.minimum, part.maximum);
  EXPECT_TRUE(shape.ok()) << shape.status();
  return shape.ok() ? *std::move(shape) : mesh::DrawnShape();
}

std::map<GeomAbs_SurfaceType, int> FaceTypes(const Solid& solid) {
  std::map<GeomAbs_SurfaceType, int> types;
  for (TopExp_Explorer face(solid.kernel().shape, TopAbs_FACE); face.More(); face.Next()) {
    ++types[BRepAdaptor_Surface(TopoDS::Face(face.Current())).GetType()];
  }
  return types;
}

Solid Stretched(const mesh::DrawnShape& shape, const Eigen::Vector3d& factors) {
  auto solid = SolidOfShape(shape, shape.size.cwiseProduct(factors), "stretched");
  EXPECT_TRUE(solid.ok()) << solid.status();
  return solid.ok() ? *std::move(solid) : Box("none", 1, 1, 1);
}

TEST(DrawnShape, AgreesWithTheSolidAtAnySize) {
  const std::vector<Solid> solids = {
      Angle("angle"),
      BoredBoard(),
      TurnedLeg(),
      SolidFrom(BRepPrimAPI_MakeSphere(0.05).Solid(), "ball"),
      SolidFrom(BRepPrimAPI_MakeTorus(0.1, 0.02).Solid(), "ring"),
      SolidFrom(BRepPrimAPI_MakeCone(0.05, 0.02, 0.1).Solid(), "cone")};
  std::mt19937 bits(11);
  std::uniform_real_distribution<double> factor(0.5, 2);
  for (const Solid& solid : solids) {
    const mesh::DrawnShape shape = Drawn(solid);
    EXPECT_NEAR(shape.volume, solid.Volume(), 1e-9 * shape.volume) << solid.name();
    for (int i = 0; i < 3; ++i) {
      Eigen::Vector3d factors(factor(bits), factor(bits), factor(bits));
      if (i >= 2) factors.y() = factors.x();  // round about z
      const Eigen::Vector3d size = shape.size.cwiseProduct(factors);
      const double volume = mesh::VolumeIn(shape, size);
      const Solid stretched = Stretched(shape, factors);
      EXPECT_NEAR(stretched.Volume(), volume, 1e-6 * volume) << solid.name();
      EXPECT_TRUE(BRepCheck_Analyzer(stretched.kernel().shape).IsValid()) << solid.name();
      const mesh::SurfaceMesh surface = mesh::SurfaceIn(shape, size);
      EXPECT_TRUE(mesh::IsWatertight(surface)) << solid.name();
      EXPECT_NEAR(mesh::ComputeMassProperties(surface).volume, volume, 0.04 * volume);
      StepPart part;
      SolidMeasurer(stretched.kernel().shape).Measure(Eigen::Isometry3d::Identity(), part);
      EXPECT_LT(part.minimum.norm(), 1e-9) << solid.name();
      EXPECT_LT((part.maximum - size).norm(), 1e-9) << solid.name();
    }
  }
}

// Stretched round things at an angle are rational splines. Their volumes are known.
TEST(DrawnShape, MeasuresSplinesExactly) {
  const double r = 0.03, top = 0.018, height = 0.4, ring = 0.05, wire = 0.004;
  const gp_Ax2 slant(gp_Pnt(0.1, 0.2, 0.3), gp_Dir(0.2, -0.1, 1));
  const std::vector<std::pair<TopoDS_Shape, double>> solids = {
      {BRepPrimAPI_MakeCone(slant, r, top, height).Solid(),
       kPi * height / 3 * (r * r + r * top + top * top)},
      {BRepPrimAPI_MakeCylinder(slant, r, height).Solid(), kPi * r * r * height},
      {BRepPrimAPI_MakeTorus(slant, ring, wire).Solid(), 2 * kPi * kPi * ring * wire * wire},
      {BRepPrimAPI_MakeTorus(slant, ring, wire, 1.0).Solid(), kPi * ring * wire * wire},
      {BRepPrimAPI_MakeSphere(slant, r).Solid(), 4 * kPi / 3 * r * r * r}};
  for (const Eigen::Vector3d& factors :
       {Eigen::Vector3d(1.3, 1, 0.6), Eigen::Vector3d(1, 2.5, 1)}) {
    for (const auto& [solid, volume] : solids) {
      const TopoDS_Shape stretched = StretchSolid(solid, StretchMap(factors), 0);
      ASSERT_FALSE(stretched.IsNull());
      const double expected = volume * factors.prod();
      EXPECT_NEAR(AccurateVolume(stretched), expected, 1e-9 * expected);
      EXPECT_NEAR(AccurateVolume(stretched.Reversed()), -expected, 1e-9 * expected) << "inside out";
    }
  }
}

TEST(DrawnShape, KeepsPlanesAndCylindersWhereTheyCanBeKept) {
  const mesh::DrawnShape board = Drawn(BoredBoard());
  const std::map<GeomAbs_SurfaceType, int> drawn = {{GeomAbs_Plane, 6}, {GeomAbs_Cylinder, 2}};
  EXPECT_EQ(FaceTypes(Stretched(board, {1, 1, 1})), drawn);
  EXPECT_EQ(FaceTypes(Stretched(board, {1.5, 1.5, 0.7})), drawn) << "across the bores alike";
  EXPECT_EQ(FaceTypes(Stretched(board, {1.3, 1.3, 1.3})), drawn);
  const mesh::DrawnShape leg = Drawn(TurnedLeg());
  EXPECT_EQ(FaceTypes(Stretched(leg, {1.2, 1.2, 0.6})), FaceTypes(TurnedLeg()));
  const mesh::DrawnShape angle = Drawn(Angle("angle"));
  EXPECT_EQ(FaceTypes(Stretched(angle, {1.2, 0.7, 1.9})), FaceTypes(Angle("angle")));
  // Bores that are stretched differently become elliptic, and nothing else changes.
  EXPECT_EQ(
      FaceTypes(Stretched(board, {1.5, 0.8, 0.7})),
      (std::map<GeomAbs_SurfaceType, int>{{GeomAbs_Plane, 6}, {GeomAbs_SurfaceOfExtrusion, 2}}));
  const mesh::DrawnShape ring = Drawn(SolidFrom(BRepPrimAPI_MakeTorus(0.1, 0.02).Solid(), "ring"));
  EXPECT_EQ(FaceTypes(Stretched(ring, {1.2, 1.2, 0.6})),
            (std::map<GeomAbs_SurfaceType, int>{{GeomAbs_SurfaceOfRevolution, 1}}));
  // An oblique face stays a plane, too.
  Eigen::Matrix2Xd wedge(2, 3);
  wedge << 0, 0.1, 0, 0, 0, 0.05;
  const mesh::DrawnShape oblique = Drawn(Prism("wedge", wedge, 0.02));
  EXPECT_EQ(FaceTypes(Stretched(oblique, {1.2, 0.7, 1.9})),
            (std::map<GeomAbs_SurfaceType, int>{{GeomAbs_Plane, 5}}));
}

// Files in millimetres have splines where the kernel has lines in the parameters of a face.
TEST(DrawnShape, KeepsCylindersThatCameInAFile) {
  for (const Solid& solid : {BoredBoard(), TurnedLeg()}) {
    const auto bytes = WriteStep("drawn", {{solid}});
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    const auto read = ReadStep(*bytes);
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_EQ(read->shapes.size(), 1u);
    const Solid stretched = Stretched(read->shapes[0], {1.5, 1.5, 0.7});
    EXPECT_EQ(FaceTypes(stretched), FaceTypes(solid)) << solid.name();
    EXPECT_TRUE(BRepCheck_Analyzer(stretched.kernel().shape).IsValid()) << solid.name();
    const double volume = solid.Volume() * 1.5 * 1.5 * 0.7;
    EXPECT_NEAR(stretched.Volume(), volume, 1e-9 * volume) << solid.name();
  }
}

TEST(DrawnShape, KnowsItsLargePlanesAndFacesOfItsBox) {
  const mesh::DrawnShape angle = Drawn(Angle("angle"));
  ASSERT_EQ(angle.planes.size(), 2u);
  EXPECT_EQ(angle.planes[0].axis, 0);
  EXPECT_NEAR(angle.planes[0].fraction, 0.1 - 0.5, 1e-9);
  EXPECT_EQ(angle.planes[1].axis, 1);
  std::map<std::string, int> names;
  for (const auto& face : angle.face_names) {
    for (std::size_t i = 1; i < face.size(); ++i) ++names[face[i]];
  }
  EXPECT_EQ(names.size(), 6u);
  EXPECT_EQ(angle.deflection, 0);
  EXPECT_GT(Drawn(TurnedLeg()).deflection, 0);
}

// How far triangles miss what is curved, where it is stretched along itself and across.
TEST(DrawnShape, MissesCurvedFacesByNoMoreAtGreaterLength) {
  const TopoDS_Shape bore = BRepPrimAPI_MakeCylinder(0.0105, 0.25).Solid();
  const Solid tube = SolidFrom(
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(0.0125, 0.25).Solid(), bore).Shape(), "tube");
  for (const auto& [solid, is_straight] :
       {std::pair(tube, true), std::pair(TurnedLeg(), false), std::pair(BoredBoard(), true)}) {
    const mesh::DrawnShape shape = Drawn(solid);
    const auto missed = [&](double x, double y, double z) {
      return mesh::DeflectionIn(shape, shape.size.cwiseProduct(Eigen::Vector3d(x, y, z)));
    };
    const double drawn = shape.deflection;
    EXPECT_GT(drawn, 0) << solid.name();
    EXPECT_DOUBLE_EQ(missed(1, 1, 1), drawn);
    EXPECT_DOUBLE_EQ(missed(1, 1, 12), is_straight ? drawn : 12 * drawn) << solid.name();
    EXPECT_DOUBLE_EQ(missed(1, 3, 1), 3 * drawn) << solid.name();
    EXPECT_DOUBLE_EQ(missed(0.5, 0.5, 0.5), 0.5 * drawn) << solid.name();
    // Turned, the same along the axis that its own length lies along then.
    const mesh::DrawnShape lying = mesh::Turned(shape, 1, 0);
    const Eigen::Vector3d longer = lying.size.cwiseProduct(Eigen::Vector3d(12, 1, 1));
    EXPECT_DOUBLE_EQ(mesh::DeflectionIn(lying, longer), is_straight ? drawn : 12 * drawn);
  }
}

TEST(DrawnShape, IsTurnedWithoutBeingMirrored) {
  const mesh::DrawnShape angle = Drawn(Angle("angle"));
  for (int x = 0; x < 3; ++x) {
    for (int z = 0; z < 3; ++z) {
      if (x == z) continue;
      const mesh::DrawnShape turned = mesh::Turned(angle, x, z);
      EXPECT_DOUBLE_EQ(turned.size[x], angle.size.x());
      EXPECT_DOUBLE_EQ(turned.size[z], angle.size.z());
      const mesh::SurfaceMesh surface = mesh::SurfaceIn(turned, turned.size);
      EXPECT_NEAR(mesh::ComputeMassProperties(surface).volume, angle.volume, 1e-12);
      const Solid solid = Stretched(turned, {1, 1, 1});
      EXPECT_NEAR(solid.Volume(), angle.volume, 1e-12);
      // The triangles and the solid are turned alike.
      const Eigen::Vector3d centroid =
          mesh::ComputeMassProperties(surface).centroid + turned.size / 2;
      EXPECT_LT((solid.CentreOfMass() - centroid).norm(), 1e-9);
    }
  }
}

TEST(DrawnShape, StandsAtAnAngleInItsBox) {
  const Eigen::Matrix3d lean = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const mesh::DrawnShape leaning = Drawn(Box("post", 0.04, 0.04, 0.7), lean);
  EXPECT_NEAR(leaning.size.z(), 0.7 * std::cos(0.2) + 0.04 * std::sin(0.2), 1e-9);
  EXPECT_NEAR(leaning.volume, 0.04 * 0.04 * 0.7, 1e-12);
  EXPECT_NEAR(Stretched(leaning, {1, 1, 1.5}).Volume(), 1.5 * leaning.volume, 1e-9);
}

TEST(DrawnShape, OfTrianglesOnlyIsASolidToo) {
  const mesh::DrawnShape angle = Drawn(Angle("angle"));
  const auto mesh = mesh::ShapeOfMesh(mesh::SurfaceIn(angle, angle.size));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_TRUE(mesh->brep.empty());
  EXPECT_EQ(mesh->planes.size(), 2u);
  const Eigen::Vector3d size = 1.7 * angle.size;
  const auto solid = SolidOfShape(*mesh, size, "mesh");
  ASSERT_TRUE(solid.ok()) << solid.status();
  EXPECT_NEAR(solid->Volume(), mesh::VolumeIn(angle, size), 1e-9 * solid->Volume());
  EXPECT_TRUE(BRepCheck_Analyzer(solid->kernel().shape).IsValid());
}

mesh::SurfaceMesh Wedge() {
  Eigen::Matrix2Xd outline(2, 3);
  outline << 0, 1, 0, 0, 0, 1;
  const mesh::DrawnShape wedge = Drawn(Prism("wedge", outline, 1));
  return mesh::SurfaceIn(wedge, wedge.size);
}

TEST(DrawnShape, IsRefusedWithThePlaceWhereItBoundsNoSolid) {
  const mesh::SurfaceMesh good = Wedge();
  ASSERT_TRUE(mesh::ShapeOfMesh(good).ok());
  mesh::SurfaceMesh open = good;
  open.triangles.conservativeResize(3, open.triangles.cols() - 1);
  const absl::Status not_closed = mesh::ShapeOfMesh(open).status();
  EXPECT_EQ(not_closed.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(not_closed.message()), HasSubstr(" mm"));
  mesh::SurfaceMesh reversed = good;
  reversed.triangles.row(0).swap(reversed.triangles.row(1));
  EXPECT_FALSE(mesh::ShapeOfMesh(reversed).ok());
  mesh::SurfaceMesh twice = good;
  twice.triangles.conservativeResize(3, good.triangles.cols() + 1);
  twice.triangles.rightCols(1) = good.triangles.leftCols(1);
  EXPECT_FALSE(mesh::ShapeOfMesh(twice).ok());
  mesh::SurfaceMesh far = good;
  far.vertices.array() += 10'001;
  EXPECT_THAT(std::string(mesh::ShapeOfMesh(far).status().message()), HasSubstr("from the origin"));
  EXPECT_FALSE(mesh::ShapeOfMesh({}).ok());
  mesh::SurfaceMesh huge;
  huge.vertices = Eigen::Matrix3Xd::Zero(3, 3);
  huge.triangles = Eigen::Matrix3Xi::Zero(3, mesh::kMaxShapeTriangles + 1);
  EXPECT_EQ(mesh::ShapeOfMesh(huge).status().code(), absl::StatusCode::kResourceExhausted);
}

TEST(DrawnShape, IsRefusedWhereItIsSeveralSolids) {
  const mesh::SurfaceMesh good = Wedge();
  // Two solids, one through the other.
  mesh::SurfaceMesh crossing;
  const Eigen::Index v = good.vertices.cols(), t = good.triangles.cols();
  crossing.vertices.resize(3, 2 * v);
  crossing.vertices << good.vertices, good.vertices.colwise() + Eigen::Vector3d(0.13, 0.17, 0.21);
  crossing.triangles.resize(3, 2 * t);
  crossing.triangles << good.triangles, good.triangles.array() + static_cast<int>(v);
  EXPECT_THAT(std::string(mesh::ShapeOfMesh(crossing).status().message()),
              HasSubstr("crosses itself"));
  mesh::SurfaceMesh apart = crossing;
  apart.vertices.rightCols(v).array() += 10;
  EXPECT_THAT(std::string(mesh::ShapeOfMesh(apart).status().message()),
              HasSubstr("2 separate solids"));
  // Beside each other, with one corner in common.
  mesh::SurfaceMesh touching = crossing;
  const Eigen::Vector3d shift(1, 0, 1);
  touching.vertices.rightCols(v) = good.vertices.colwise() + shift;
  for (int i = 0; i < v; ++i) {
    for (int j = 0; j < v; ++j) {
      if ((good.vertices.col(i) - good.vertices.col(j) - shift).norm() > 1e-9) continue;
      touching.triangles =
          (touching.triangles.array() == static_cast<int>(v) + j).select(i, touching.triangles);
    }
  }
  EXPECT_THAT(std::string(mesh::ShapeOfMesh(touching).status().message()),
              HasSubstr("2 solids that meet only in a vertex, at (500.000, -500.000, 500.000) mm"));
  // One within the other, turned inwards, is a hollow.
  mesh::SurfaceMesh hollow = apart;
  const Eigen::Vector3d within = good.vertices.rowwise().mean();
  hollow.vertices.rightCols(v) = ((good.vertices.colwise() - within) / 10).colwise() + within;
  EXPECT_THAT(std::string(mesh::ShapeOfMesh(hollow).status().message()),
              HasSubstr("2 separate solids"));
  hollow.triangles.rightCols(t).row(0).swap(hollow.triangles.rightCols(t).row(1));
  EXPECT_TRUE(mesh::ShapeOfMesh(hollow).ok());
}

// What STEP has is what is written after it was read, stretched, written and read again.
TEST(DrawnShape, GoesThroughFilesAtAnySize) {
  StepAssembly stand;
  stand.name = "stand";
  stand.groups = {{"stand", -1, At(0, 0, 0)}, {"legs", 0, At(0.1, 0, 0)}};
  stand.products = {{"board", BoredBoard(), Eigen::Vector3d(0.5, 0.25, 0.125)},
                    {"leg", TurnedLeg(), std::nullopt}};
  AddPart(stand, "board", 0, 0, At(0, 0, 0.4));
  AddPart(stand, "leg a", 1, 1, At(0, 0, 0));
  AddPart(stand, "leg b", 1, 1, At(0.2, 0, 0));
  AddPart(stand, "leg c", 1, 1, At(0.2, 0.4, 0, kPi / 2, {0, 1, 0}));
  const auto bytes = WriteStep(stand);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  auto read = ReadStep(*bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->shapes.size(), 3u) << "of each product and way it is turned";
  const auto shape_of = [&](const std::string& name) {
    for (const StepPart& part : read->parts) {
      if (part.name == name) return part.shape;
    }
    return -1;
  };
  EXPECT_EQ(shape_of("leg a"), shape_of("leg b"));
  const auto sent = StepAssemblyFromJson(ToJson(*read));
  ASSERT_TRUE(sent.ok()) << sent.status();
  ASSERT_EQ(sent->shapes.size(), 3u);
  for (const Eigen::Vector3d& factors :
       {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1.5, 1.5, 0.8), Eigen::Vector3d(0.7, 1.9, 1.2)}) {
    StepAssembly again;
    again.name = "again";
    again.groups = {{"again", -1, At(0, 0, 0)}};
    for (std::size_t i = 0; i < sent->shapes.size(); ++i) {
      again.products.push_back({"shape", Stretched(sent->shapes[i], factors), std::nullopt});
      AddPart(again, absl::StrCat("part ", i), 0, static_cast<int>(i), At(0, 0, 0));
    }
    const auto written = WriteStep(again);
    ASSERT_TRUE(written.ok()) << written.status();
    const auto back = ReadStep(*written);
    ASSERT_TRUE(back.ok()) << back.status();
    ASSERT_EQ(back->parts.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const mesh::DrawnShape& shape = sent->shapes[i];
      const double volume = mesh::VolumeIn(shape, shape.size.cwiseProduct(factors));
      EXPECT_NEAR(back->parts[i].volume, volume, 1e-6 * volume) << i;
      EXPECT_TRUE(back->parts[i].faults.empty());
    }
  }
}

}  // namespace
}  // namespace mortise::cad
