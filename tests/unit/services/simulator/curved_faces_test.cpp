// Solids with curved faces, from their exact surfaces to stresses that are known.
#include <gtest/gtest.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <Eigen/Geometry>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <memory>
#include <string>

#include "common/cad/assembly_surface.h"
#include "common/cad/solid_kernel.h"
#include "published_targets.h"
#include "services/simulator/design_analysis.h"

namespace mortise::simulator {
namespace {

// The solid of a shape whose faces are named by where they are: "x_min" where the outward normal of
// a plane is along -x; "inside" and "outside", of cylinders, by their radius.
cad::Solid Named(const TopoDS_Shape& shape, double inner_radius) {
  auto kernel = std::make_shared<cad::Solid::Kernel>();
  kernel->name = "body";
  kernel->shape = TopExp_Explorer(shape, TopAbs_SOLID).Current();
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(kernel->shape, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) {
    const TopoDS_Face face = TopoDS::Face(faces(i));
    const BRepAdaptor_Surface surface(face);
    std::string name;
    if (surface.GetType() == GeomAbs_Cylinder) {
      const bool is_inside = surface.Cylinder().Radius() < 1.01 * inner_radius;
      name = is_inside ? "inside" : "outside";
    } else {
      gp_Dir normal = surface.Plane().Axis().Direction();
      if (!surface.Plane().Direct()) normal.Reverse();
      if (face.Orientation() == TopAbs_REVERSED) normal.Reverse();
      for (int axis = 0; axis < 3; ++axis) {
        const double along = normal.XYZ().Coord(axis + 1);
        if (std::abs(along) > 0.9)
          name = std::string(1, "xyz"[axis]) + (along > 0 ? "_max" : "_min");
      }
    }
    kernel->faces.push_back(face);
    kernel->face_names.push_back(name);
  }
  return cad::Solid(std::move(kernel));
}

TopoDS_Shape Rod(double radius, double height) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), radius, height).Solid();
}

DesignModel ModelOf(const TopoDS_Shape& shape, double inner_radius, double element_size) {
  const auto surface =
      cad::FuseAssembly({Named(shape, inner_radius)}, {.element_size = element_size});
  EXPECT_TRUE(surface.ok()) << surface.status();
  DesignModel model{*surface, {}};
  model.analysis.materials = {{"steel", 7800, 200e9, 0.3, 250e6}};
  for (const char* plane : {"x_min", "y_min", "z_min", "z_max"}) {
    Support support{{0, plane}};
    support.symmetric = true;
    model.analysis.supports.push_back(support);
  }
  return model;
}

DesignAnalysis Solved(const DesignModel& model, double element_size) {
  DesignAnalysisOptions options;
  options.mesh.element_size = element_size;
  auto analysis = AnalyzeDesign(model, {"max_displacement", "max_von_mises"}, false, options);
  EXPECT_TRUE(analysis.ok()) << analysis.status();
  return *std::move(analysis);
}

// The stress along a direction at the node nearest to a place.
double StressNear(const DesignAnalysis& analysis, const Eigen::Vector3d& place, int component) {
  Eigen::Index node = 0;
  (analysis.mesh->nodes.colwise() - place).colwise().squaredNorm().minCoeff(&node);
  return analysis.cases[0].solution.stress(component, node);
}

// A plate with a hole of 20 mm under the tractions of Kirsch's solution (1898) for 1 MPa along x at
// infinity, in plane strain: three times as much at the hole.
TEST(CurvedFacesTest, ConcentrateStressAtAHole) {
  constexpr double kRadius = 0.01, kSide = 0.04, kThickness = 0.004, kPull = 1e6, kSize = 0.002;
  const TopoDS_Shape plate = BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(kSide, kSide, kThickness).Solid(),
                                             Rod(kRadius, kThickness))
                                 .Shape();
  DesignModel model = ModelOf(plate, kRadius, kSize);
  for (const char* side : {"x_max", "y_max"}) {
    model.analysis.tractions.push_back(
        {{0, side}, [](const Eigen::Vector3d& x, const Eigen::Vector3d& normal) {
           return KirschTraction(kRadius, kPull, x, normal);
         }});
  }
  const DesignAnalysis analysis = Solved(model, kSize);
  EXPECT_NEAR(StressNear(analysis, {0, kRadius, kThickness / 2}, 0), 3 * kPull, 0.03 * kPull);
  EXPECT_NEAR(StressNear(analysis, {kRadius, 0, kThickness / 2}, 1), -kPull, 0.03 * kPull);
}

// Lamé's thick cylinder, 20 mm inside and 40 mm outside, under 1 MPa inside, in plane strain.
TEST(CurvedFacesTest, HoldAPressureInside) {
  constexpr double kInner = 0.01, kOuter = 0.02, kHeight = 0.004, kPressure = 1e6, kSize = 0.002;
  const TopoDS_Shape ring = BRepAlgoAPI_Cut(Rod(kOuter, kHeight), Rod(kInner, kHeight)).Shape();
  const TopoDS_Shape quarter =
      BRepAlgoAPI_Common(ring, BRepPrimAPI_MakeBox(kOuter, kOuter, kHeight).Solid()).Shape();
  DesignModel model = ModelOf(quarter, kInner, kSize);
  model.analysis.pressures.push_back({{0, "inside"}, kPressure});
  const DesignAnalysis analysis = Solved(model, kSize);
  const double a2 = kInner * kInner, b2 = kOuter * kOuter;
  const double hoop = kPressure * (a2 + b2) / (b2 - a2);
  const double widening = kPressure * kInner * 1.3 * (0.4 * a2 + b2) / (200e9 * (b2 - a2));
  EXPECT_NEAR(analysis.metrics[0].value, widening, 5e-4 * widening);
  int inside = 0;
  for (Eigen::Index v = 0; v < analysis.mesh->nodes.cols(); ++v) {
    const Eigen::Vector2d at = analysis.mesh->nodes.col(v).head<2>();
    if (at.norm() > 1.001 * kInner) continue;
    const Eigen::Vector2d t = Eigen::Vector2d(-at.y(), at.x()).normalized();
    const auto stress = analysis.cases[0].solution.stress.col(v);
    const double found =
        stress[0] * t.x() * t.x() + stress[1] * t.y() * t.y() + 2 * stress[3] * t.x() * t.y();
    EXPECT_NEAR(found, hoop, 0.02 * hoop) << "at " << at.transpose();
    ++inside;
  }
  EXPECT_GT(inside, 20);
}

}  // namespace
}  // namespace mortise::simulator
