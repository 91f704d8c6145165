#include "common/cad/solid_stretch.h"

#include <BRepBuilderAPI_GTransform.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepTools_Modification.hxx>
#include <BRepTools_Modifier.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <gp_GTrsf.hxx>
#include <gp_Lin.hxx>
#include <optional>

#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

constexpr double kSame = 1e-9;      // factors and lengths that differ by less, relatively, are one
constexpr double kParallel = 1e-9;  // sine of an angle
constexpr double kVolumeError = 1e-6;  // relative

template <class Curve, class Trimmed>
Handle(Curve) Untrimmed(Handle(Curve) curve) {
  for (;;) {
    const auto trimmed = Handle(Trimmed)::DownCast(curve);
    if (trimmed.IsNull()) return curve;
    curve = trimmed->BasisCurve();
  }
}

Handle(Geom_Surface) Untrimmed(Handle(Geom_Surface) surface) {
  for (;;) {
    const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
    if (trimmed.IsNull()) return surface;
    surface = trimmed->BasisSurface();
  }
}

// A curve, whose point at `scale` t + `shift` is that of the drawn one at t, stretched.
struct StretchedCurve {
  Handle(Geom_Curve) curve;
  double scale = 1;
  double shift = 0;
};

// A surface, whose point at (u + `u_shift`, `v_scale` v + `v_shift`) is that of the drawn one at
// (u, v), stretched. Of planes that does not hold.
struct StretchedSurface {
  Handle(Geom_Surface) surface;
  double u_shift = 0;
  double v_scale = 1;
  double v_shift = 0;
};

// Stretches the curves and surfaces of which solids mostly consist by themselves: lines, conics and
// splines, planes, and what is swept along or about a coordinate axis.
class Stretcher {
 public:
  explicit Stretcher(const Eigen::Vector3d& factors) : factors_(factors) {}

  gp_XYZ Point(const gp_XYZ& p) const {
    return {factors_[0] * p.X(), factors_[1] * p.Y(), factors_[2] * p.Z()};
  }

  double Grown(double tolerance) const { return tolerance * std::max(1.0, factors_.maxCoeff()); }

  std::optional<StretchedCurve> Curve(const Handle(Geom_Curve) & drawn) const {
    const auto basis = Untrimmed<Geom_Curve, Geom_TrimmedCurve>(drawn);
    if (const auto line = Handle(Geom_Line)::DownCast(basis); !line.IsNull()) {
      const gp_XYZ direction = Point(line->Lin().Direction().XYZ());
      return StretchedCurve{
          new Geom_Line(gp_Pnt(Point(line->Lin().Location().XYZ())), gp_Dir(direction)),
          direction.Modulus(), 0};
    }
    if (const auto circle = Handle(Geom_Circle)::DownCast(basis); !circle.IsNull()) {
      return Conic(circle->Position(), circle->Radius(), circle->Radius());
    }
    if (const auto ellipse = Handle(Geom_Ellipse)::DownCast(basis); !ellipse.IsNull()) {
      if (AxisAlong(ellipse->Position().XDirection()) < 0) return std::nullopt;
      return Conic(ellipse->Position(), ellipse->MajorRadius(), ellipse->MinorRadius());
    }
    if (const auto spline = Handle(Geom_BSplineCurve)::DownCast(basis); !spline.IsNull()) {
      const auto stretched = Handle(Geom_BSplineCurve)::DownCast(spline->Copy());
      for (int i = 1; i <= stretched->NbPoles(); ++i) {
        stretched->SetPole(i, gp_Pnt(Point(stretched->Pole(i).XYZ())));
      }
      return StretchedCurve{Handle(Geom_Curve)(stretched)};
    }
    return std::nullopt;
  }

  std::optional<StretchedSurface> Surface(const Handle(Geom_Surface) & drawn) const {
    const Handle(Geom_Surface) basis = Untrimmed(drawn);
    if (const auto plane = Handle(Geom_Plane)::DownCast(basis); !plane.IsNull()) {
      return Plane(plane->Position());
    }
    if (const auto cylinder = Handle(Geom_CylindricalSurface)::DownCast(basis);
        !cylinder.IsNull()) {
      return Cylinder(cylinder->Position(), cylinder->Radius());
    }
    if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(basis); !cone.IsNull()) {
      return Cone(cone->Position(), cone->RefRadius(), cone->SemiAngle());
    }
    if (const auto torus = Handle(Geom_ToroidalSurface)::DownCast(basis); !torus.IsNull()) {
      return Ring(torus->Position(), torus->MajorRadius(), torus->MinorRadius());
    }
    if (const auto turned = Handle(Geom_SurfaceOfRevolution)::DownCast(basis); !turned.IsNull()) {
      return Turned(turned->Axis(), turned->BasisCurve());
    }
    if (const auto swept = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(basis);
        !swept.IsNull()) {
      const auto curve = Curve(swept->BasisCurve());
      if (!curve || curve->scale != 1) return std::nullopt;
      const gp_XYZ direction = Point(swept->Direction().XYZ());
      return StretchedSurface{new Geom_SurfaceOfLinearExtrusion(curve->curve, gp_Dir(direction)),
                              curve->shift, direction.Modulus(), 0};
    }
    return std::nullopt;
  }

 private:
  // The coordinate axis along `direction`; -1 if there is none.
  static int AxisAlong(const gp_Dir& direction) {
    for (int axis = 0; axis < 3; ++axis) {
      const double other =
          std::hypot(direction.Coord((axis + 1) % 3 + 1), direction.Coord((axis + 2) % 3 + 1));
      if (other <= kParallel) return axis;
    }
    return -1;
  }

  // The axis, if what is round about it stays round.
  int RoundAbout(const gp_Dir& direction) const {
    const int axis = AxisAlong(direction);
    if (axis < 0) return -1;
    const double a = factors_[(axis + 1) % 3], b = factors_[(axis + 2) % 3];
    return std::abs(a - b) <= kSame * a ? axis : -1;
  }

  // Circles, and ellipses whose axes are those of the coordinates.
  std::optional<StretchedCurve> Conic(const gp_Ax2& position, double along_x,
                                      double along_y) const {
    const int normal = AxisAlong(position.Direction());
    if (normal < 0) return std::nullopt;
    const gp_Pnt center(Point(position.Location().XYZ()));
    if (along_x == along_y && RoundAbout(position.Direction()) >= 0) {
      return StretchedCurve{
          new Geom_Circle(gp_Ax2(center, position.Direction(), position.XDirection()),
                          factors_[(normal + 1) % 3] * along_x)};
    }
    // Along either of the two axes across, how long it becomes.
    const auto unit = [](int axis) { return gp_Dir(axis == 0, axis == 1, axis == 2); };
    const auto radius = [&](int axis) {
      const bool is_x = std::abs(position.XDirection().Dot(gp_Dir(unit(axis)))) > 0.5;
      return factors_[axis] * (along_x == along_y || is_x ? along_x : along_y);
    };
    int longer = (normal + 1) % 3, shorter = (normal + 2) % 3;
    if (radius(shorter) > radius(longer)) std::swap(longer, shorter);
    // Of both ways along the longer axis that which shifts least, and forwards: the kernel mistakes
    // the direction of closed ellipses that begin before their own parameter 0.
    gp_Dir along = unit(longer);
    const gp_Dir& x = position.XDirection();
    if (x.Dot(along) < -kParallel || x.Dot(position.Direction().Crossed(along)) < -kParallel) {
      along.Reverse();
    }
    const gp_Ax2 axes(center, position.Direction(), along);
    const double shift = std::atan2(x.Dot(axes.YDirection()), x.Dot(axes.XDirection()));
    return StretchedCurve{new Geom_Ellipse(axes, radius(longer), radius(shorter)), 1,
                          std::max(0.0, shift)};
  }

  StretchedSurface Plane(const gp_Ax3& position) const {
    const gp_XYZ n = position.Direction().XYZ();
    const gp_Dir normal(n.X() / factors_[0], n.Y() / factors_[1], n.Z() / factors_[2]);
    gp_Ax3 moved(gp_Pnt(Point(position.Location().XYZ())), normal,
                 gp_Dir(Point(position.XDirection().XYZ())));
    if (!position.Direct()) moved.YReverse();
    return {new Geom_Plane(moved)};
  }

  std::optional<StretchedSurface> Cylinder(gp_Ax3 position, double radius) const {
    const int axis = AxisAlong(position.Direction());
    if (axis < 0) return std::nullopt;
    if (RoundAbout(position.Direction()) >= 0) {
      position.SetLocation(gp_Pnt(Point(position.Location().XYZ())));
      return StretchedSurface{
          new Geom_CylindricalSurface(position, factors_[(axis + 1) % 3] * radius), 0,
          factors_[axis], 0};
    }
    if (!position.Direct()) return std::nullopt;
    const auto outline = Conic(position.Ax2(), radius, radius);
    if (!outline) return std::nullopt;
    return StretchedSurface{new Geom_SurfaceOfLinearExtrusion(outline->curve, position.Direction()),
                            outline->shift, factors_[axis], 0};
  }

  std::optional<StretchedSurface> Cone(gp_Ax3 position, double radius, double angle) const {
    const int axis = RoundAbout(position.Direction());
    if (axis < 0) return std::nullopt;
    const double across = factors_[(axis + 1) % 3];
    const double out = across * std::sin(angle), along = factors_[axis] * std::cos(angle);
    position.SetLocation(gp_Pnt(Point(position.Location().XYZ())));
    return StretchedSurface{
        new Geom_ConicalSurface(position, std::atan2(out, along), across * radius), 0,
        std::hypot(out, along), 0};
  }

  // A torus, turned about its axis from the circle in the plane of X. (A sphere's circle would
  // cross the axis, which the kernel does not bear.)
  std::optional<StretchedSurface> Ring(const gp_Ax3& position, double major, double minor) const {
    if (RoundAbout(position.Direction()) < 0 || !position.Direct()) return std::nullopt;
    if (AxisAlong(position.XDirection()) < 0) return std::nullopt;
    const gp_XYZ x = position.XDirection().XYZ();
    const gp_Ax2 section(gp_Pnt(position.Location().XYZ() + major * x),
                         position.YDirection().Reversed(), position.XDirection());
    return Turned(position.Axis(), new Geom_Circle(section, minor));
  }

  std::optional<StretchedSurface> Turned(const gp_Ax1& axis,
                                         const Handle(Geom_Curve) & meridian) const {
    if (RoundAbout(axis.Direction()) < 0) return std::nullopt;
    const auto curve = Curve(meridian);
    if (!curve) return std::nullopt;
    return StretchedSurface{
        new Geom_SurfaceOfRevolution(
            curve->curve, gp_Ax1(gp_Pnt(Point(axis.Location().XYZ())), axis.Direction())),
        0, curve->scale, curve->shift};
  }

  const Eigen::Vector3d factors_;
};

// The kernel's way to change the geometry of a solid and keep how it hangs together.
class ExactStretch : public BRepTools_Modification {
 public:
  explicit ExactStretch(const Eigen::Vector3d& factors) : stretch_(factors) {}

  // Whether all of the solid can be stretched so.
  bool Suits(const TopoDS_Shape& solid) const {
    for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
      if (!stretch_.Surface(BRep_Tool::Surface(TopoDS::Face(face.Current())))) return false;
      for (TopExp_Explorer edge(face.Current(), TopAbs_EDGE); edge.More(); edge.Next()) {
        if (!Suits(TopoDS::Edge(edge.Current()), TopoDS::Face(face.Current()))) return false;
      }
    }
    return true;
  }

  Standard_Boolean NewSurface(const TopoDS_Face& face, Handle(Geom_Surface) & surface,
                              TopLoc_Location& location, Standard_Real& tolerance,
                              Standard_Boolean& reverses_wires,
                              Standard_Boolean& reverses_face) override {
    surface = stretch_.Surface(BRep_Tool::Surface(face))->surface;
    location.Identity();
    tolerance = stretch_.Grown(BRep_Tool::Tolerance(face));
    reverses_wires = reverses_face = Standard_False;
    return Standard_True;
  }

  Standard_Boolean NewCurve(const TopoDS_Edge& edge, Handle(Geom_Curve) & curve,
                            TopLoc_Location& location, Standard_Real& tolerance) override {
    curve = CurveOf(edge).curve;
    location.Identity();
    tolerance = stretch_.Grown(BRep_Tool::Tolerance(edge));
    return Standard_True;
  }

  Standard_Boolean NewPoint(const TopoDS_Vertex& vertex, gp_Pnt& point,
                            Standard_Real& tolerance) override {
    point = gp_Pnt(stretch_.Point(BRep_Tool::Pnt(vertex).XYZ()));
    tolerance = stretch_.Grown(BRep_Tool::Tolerance(vertex));
    return Standard_True;
  }

  Standard_Boolean NewCurve2d(const TopoDS_Edge& edge, const TopoDS_Face& face,
                              const TopoDS_Edge& new_edge, const TopoDS_Face&,
                              Handle(Geom2d_Curve) & curve, Standard_Real& tolerance) override {
    if (IsPlanar(face)) return Standard_False;
    curve = CurveOn(edge, face);
    tolerance = BRep_Tool::Tolerance(new_edge);
    return !curve.IsNull();
  }

  Standard_Boolean NewParameter(const TopoDS_Vertex& vertex, const TopoDS_Edge& edge,
                                Standard_Real& parameter, Standard_Real& tolerance) override {
    tolerance = stretch_.Grown(BRep_Tool::Tolerance(vertex));
    const StretchedCurve curve = CurveOf(edge);
    parameter = curve.scale * BRep_Tool::Parameter(vertex, edge) + curve.shift;
    return Standard_True;
  }

  GeomAbs_Shape Continuity(const TopoDS_Edge& edge, const TopoDS_Face& one,
                           const TopoDS_Face& other, const TopoDS_Edge&, const TopoDS_Face&,
                           const TopoDS_Face&) override {
    return BRep_Tool::Continuity(edge, one, other);
  }

 private:
  // Curves on planes follow from those in space.
  static bool IsPlanar(const TopoDS_Face& face) {
    return !Handle(Geom_Plane)::DownCast(Untrimmed(BRep_Tool::Surface(face))).IsNull();
  }

  // Without a curve for an edge that is only a point.
  StretchedCurve CurveOf(const TopoDS_Edge& edge) const {
    double first = 0, last = 0;
    const auto curve = BRep_Tool::Curve(edge, first, last);
    if (curve.IsNull()) return {};
    return stretch_.Curve(curve).value_or(StretchedCurve{});
  }

  // The edge in the parameters of the stretched face; null if it is neither a line nor a spline.
  Handle(Geom2d_Curve) CurveOn(const TopoDS_Edge& edge, const TopoDS_Face& face) const {
    double first = 0, last = 0;
    const auto drawn = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (drawn.IsNull()) return nullptr;
    const auto basis = Untrimmed<Geom2d_Curve, Geom2d_TrimmedCurve>(drawn);
    const StretchedSurface surface = *stretch_.Surface(BRep_Tool::Surface(face));
    const StretchedCurve curve = CurveOf(edge);
    const auto moved = [&](const gp_XY& p) {
      return gp_XY(p.X() + surface.u_shift, surface.v_scale * p.Y() + surface.v_shift);
    };
    if (const auto line = Handle(Geom2d_Line)::DownCast(basis); !line.IsNull()) {
      gp_XY along = line->Direction().XY();
      along.SetY(surface.v_scale * along.Y());
      along /= curve.scale;
      if (std::abs(along.Modulus() - 1) > kSame) return nullptr;
      return new Geom2d_Line(gp_Pnt2d(moved(line->Location().XY()) - curve.shift * along),
                             gp_Dir2d(along));
    }
    const auto spline = Handle(Geom2d_BSplineCurve)::DownCast(basis);
    if (spline.IsNull()) return nullptr;
    const auto stretched = Handle(Geom2d_BSplineCurve)::DownCast(spline->Copy());
    for (int i = 1; i <= stretched->NbPoles(); ++i) {
      stretched->SetPole(i, gp_Pnt2d(moved(stretched->Pole(i).XY())));
    }
    TColStd_Array1OfReal knots = stretched->Knots();
    for (double& knot : knots) knot = curve.scale * knot + curve.shift;
    stretched->SetKnots(knots);
    return Handle(Geom2d_Curve)(stretched);
  }

  bool Suits(const TopoDS_Edge& edge, const TopoDS_Face& face) const {
    double first = 0, last = 0;
    const auto curve = BRep_Tool::Curve(edge, first, last);
    if (curve.IsNull() != BRep_Tool::Degenerated(edge)) return false;
    if (!curve.IsNull() && !stretch_.Curve(curve)) return false;
    return IsPlanar(face) || !CurveOn(edge, face).IsNull();
  }

  const Stretcher stretch_;
};

TopoDS_Shape General(const TopoDS_Shape& solid, const Eigen::Vector3d& factors) {
  gp_GTrsf stretch;
  for (int axis = 0; axis < 3; ++axis) stretch.SetValue(axis + 1, axis + 1, factors[axis]);
  return BRepBuilderAPI_GTransform(solid, stretch, Standard_True).Shape();
}

bool IsRight(const TopoDS_Shape& stretched, double volume) {
  return !stretched.IsNull() && BRepCheck_Analyzer(stretched).IsValid() &&
         std::abs(AccurateVolume(stretched) - volume) <= kVolumeError * volume;
}

}  // namespace

TopoDS_Shape StretchSolid(const TopoDS_Shape& solid, const Eigen::Vector3d& factors) {
  if (factors.maxCoeff() - factors.minCoeff() <= kSame * factors.maxCoeff()) {
    gp_Trsf scale;
    scale.SetScale(gp_Pnt(0, 0, 0), factors[0]);
    return BRepBuilderAPI_Transform(solid, scale, Standard_True).Shape();
  }
  const double volume = AccurateVolume(solid) * factors.prod();
  const Handle(ExactStretch) exact = new ExactStretch(factors);
  if (exact->Suits(solid)) {
    BRepTools_Modifier modifier(solid, exact);
    if (modifier.IsDone()) {
      const TopoDS_Shape stretched = modifier.ModifiedShape(solid);
      if (IsRight(stretched, volume)) return stretched;
    }
  }
  const TopoDS_Shape stretched = General(solid, factors);
  return IsRight(stretched, volume) ? stretched : TopoDS_Shape();
}

}  // namespace mortise::cad
