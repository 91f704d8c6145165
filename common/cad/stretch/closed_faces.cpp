#include "common/cad/stretch/closed_faces.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Splitter.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <ShapeUpgrade_ShapeDivideClosed.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <cmath>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>
#include <optional>

#include "common/cad/stretch/stretched_curve.h"

namespace mortise::cad {
namespace {

// The kernel's tolerances are made for millimetres.
constexpr double kMillimetres = 1000;
// rad, from the seam of a ball or ring to the plane that cuts it: none that drawings have.
constexpr double kAngles[] = {0.7, 1.9};

TopoDS_Shape Scaled(const TopoDS_Shape& shape, double factor) {
  gp_Trsf scale;
  scale.SetScale(gp_Pnt(0, 0, 0), factor);
  return BRepBuilderAPI_Transform(shape, scale, Standard_True).Shape();
}

bool ClosesOnItself(const TopoDS_Face& face) {
  const Handle(Geom_Surface) surface = Untrimmed(BRep_Tool::Surface(face));
  if (const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface); !spline.IsNull()) {
    return spline->IsUClosed() || spline->IsVClosed();
  }
  return !Handle(Geom_SphericalSurface)::DownCast(surface).IsNull() ||
         !Handle(Geom_ToroidalSurface)::DownCast(surface).IsNull() ||
         !Handle(Geom_SurfaceOfRevolution)::DownCast(surface).IsNull();
}

// Planes through the axes of balls and rings, and across those of rings.
TopTools_ListOfShape PlanesThrough(const TopoDS_Shape& solid, double angle) {
  Bnd_Box box;
  BRepBndLib::Add(solid, box);
  const double far = 2 * std::sqrt(box.SquareExtent());
  TopTools_ListOfShape planes;
  const auto add = [&](const gp_Pnt& at, const gp_Dir& normal) {
    planes.Append(BRepBuilderAPI_MakeFace(gp_Pln(at, normal), -far, far, -far, far).Face());
  };
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    const BRepAdaptor_Surface surface(TopoDS::Face(face.Current()), Standard_False);
    const bool is_ring = surface.GetType() == GeomAbs_Torus;
    if (!is_ring && surface.GetType() != GeomAbs_Sphere) continue;
    const gp_Ax3 position = is_ring ? surface.Torus().Position() : surface.Sphere().Position();
    add(position.Location(), position.XDirection().Rotated(position.Axis(), angle));
    if (!is_ring) continue;
    const double up = surface.Torus().MinorRadius() * std::sin(angle);
    add(position.Location().Translated(gp_Vec(position.Direction()) * up), position.Direction());
  }
  return planes;
}

TopoDS_Shape CutByPlanes(const TopoDS_Shape& solid, double angle) {
  TopTools_ListOfShape shells;
  for (TopExp_Explorer shell(solid, TopAbs_SHELL); shell.More(); shell.Next()) {
    shells.Append(shell.Current());
  }
  BRepAlgoAPI_Splitter splitter;
  splitter.SetArguments(shells);
  splitter.SetTools(PlanesThrough(solid, angle));
  splitter.SetNonDestructive(Standard_True);
  splitter.Build();
  if (!splitter.IsDone()) return {};
  BRep_Builder builder;
  TopoDS_Solid cut;
  builder.MakeSolid(cut);
  for (const TopoDS_Shape& shell : shells) {
    TopoDS_Shell pieces;
    builder.MakeShell(pieces);
    for (TopExp_Explorer face(shell, TopAbs_FACE); face.More(); face.Next()) {
      const TopTools_ListOfShape& of_face = splitter.Modified(face.Current());
      if (of_face.IsEmpty()) builder.Add(pieces, face.Current());
      for (const TopoDS_Shape& piece : of_face) {
        builder.Add(pieces, piece.Oriented(face.Current().Orientation()));
      }
    }
    pieces.Closed(Standard_True);
    builder.Add(cut, pieces);
  }
  return cut;
}

TopoDS_Shape Divided(const TopoDS_Shape& solid, int cuts) {
  ShapeUpgrade_ShapeDivideClosed divide(solid);
  divide.SetNbSplitPoints(cuts);
  return divide.Perform() ? divide.Result() : TopoDS_Shape();
}

}  // namespace

bool HasClosedFaces(const TopoDS_Shape& solid) {
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    if (ClosesOnItself(TopoDS::Face(face.Current()))) return true;
  }
  return false;
}

TopoDS_Shape CutOpen(const TopoDS_Shape& solid, int way) {
  constexpr int kAngleCount = static_cast<int>(std::size(kAngles));
  if (way >= kAngleCount) return Divided(solid, way - kAngleCount + 1);
  const TopoDS_Shape cut = CutByPlanes(Scaled(solid, kMillimetres), kAngles[way]);
  return cut.IsNull() ? cut : Scaled(cut, 1 / kMillimetres);
}

}  // namespace mortise::cad
