#include "common/cad/solid_stretch.h"

#include <BRepBuilderAPI_GTransform.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepTools_Modification.hxx>
#include <BRepTools_Modifier.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box2d.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_Plane.hxx>
#include <NCollection_DataMap.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <functional>
#include <gp_GTrsf.hxx>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/cad/fitted_curve.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/stretched_curve.h"
#include "common/cad/stretched_surface.h"

namespace mortise::cad {
namespace {

constexpr double kSame = 1e-9;      // factors and lengths that differ by less, relatively, are one
constexpr double kFit = 1e-11;      // of a parameter
constexpr double kShortest = 1e-9;  // piece of a curve, of its length
const Eigen::Vector3d kUneven(1.25, 1, 1.5);
constexpr int kLooks = 32;             // along an edge
constexpr double kVolumeError = 1e-6;  // relative

// Where a curve in a face's parameters crosses the knots of the surface's splines. Without a knot
// in between, pieces of it are smooth where the curve is.
void AddCrossings(const std::function<double(double)>& at, const std::vector<double>& knots,
                  double from, double to, std::vector<double>& breaks) {
  for (const double knot : knots) {
    double before = from;
    bool was_below = at(before) < knot;
    for (int look = 1; look <= kLooks; ++look) {
      const double now = from + (to - from) * look / kLooks;
      const bool is_below = at(now) < knot;
      if (is_below != was_below) {
        double low = before, high = now;
        for (int halving = 0; halving < 50; ++halving) {
          const double middle = (low + high) / 2;
          ((at(middle) < knot) == was_below ? low : high) = middle;
        }
        breaks.push_back(low);
      }
      before = now;
      was_below = is_below;
    }
  }
}

// The ends of an edge in a face's parameters, and where it is not smooth there.
std::vector<double> BreaksOf(const Geom2dAdaptor_Curve& curve, const StretchedSurface& surface) {
  TColStd_Array1OfReal smooth(1, curve.NbIntervals(GeomAbs_CN) + 1);
  curve.Intervals(smooth, GeomAbs_CN);
  std::vector<double> breaks(smooth.begin(), smooth.end());
  const std::size_t pieces = breaks.size() - 1;
  for (std::size_t i = 0; i < pieces; ++i) {
    AddCrossings([&](double t) { return curve.Value(t).X(); }, surface.u.knots,
                 smooth[static_cast<int>(i) + 1], smooth[static_cast<int>(i) + 2], breaks);
    AddCrossings([&](double t) { return curve.Value(t).Y(); }, surface.v.knots,
                 smooth[static_cast<int>(i) + 1], smooth[static_cast<int>(i) + 2], breaks);
  }
  std::sort(breaks.begin(), breaks.end());
  const double least = kShortest * (breaks.back() - breaks.front());
  std::vector<double> apart{breaks.front()};
  for (const double at : breaks) {
    if (at - apart.back() > least && breaks.back() - at > least) apart.push_back(at);
  }
  apart.push_back(breaks.back());
  return apart;
}

ParameterRange RangeOf(const TopoDS_Face& face) {
  Bnd_Box2d box;
  for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) {
    double first = 0, last = 0;
    const auto curve = BRep_Tool::CurveOnSurface(TopoDS::Edge(edge.Current()), face, first, last);
    if (curve.IsNull()) continue;
    for (int look = 0; look <= kLooks; ++look) {
      box.Add(curve->Value(first + (last - first) * look / kLooks));
    }
  }
  ParameterRange range;
  if (!box.IsVoid()) box.Get(range.u_minimum, range.v_minimum, range.u_maximum, range.v_maximum);
  return range;
}

// The kernel's way to change the geometry of a solid and keep how it hangs together.
class ExactStretch : public BRepTools_Modification {
 public:
  explicit ExactStretch(const Eigen::Vector3d& factors) : factors_(factors) {}

  // Whether all of the solid can be stretched so. Must be asked first.
  bool Suits(const TopoDS_Shape& solid) {
    for (TopExp_Explorer found(solid, TopAbs_FACE); found.More(); found.Next()) {
      const TopoDS_Face face = TopoDS::Face(found.Current());
      const auto surface = StretchSurface(BRep_Tool::Surface(face), factors_, RangeOf(face));
      if (!surface) return false;
      surfaces_.Bind(face, *surface);
      for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) {
        if (!Suits(TopoDS::Edge(edge.Current()), face)) return false;
      }
    }
    return true;
  }

  Standard_Boolean NewSurface(const TopoDS_Face& face, Handle(Geom_Surface) & surface,
                              TopLoc_Location& location, Standard_Real& tolerance,
                              Standard_Boolean& reverses_wires,
                              Standard_Boolean& reverses_face) override {
    surface = surfaces_.Find(face).surface;
    location.Identity();
    tolerance = Grown(BRep_Tool::Tolerance(face));
    reverses_wires = reverses_face = Standard_False;
    return Standard_True;
  }

  Standard_Boolean NewCurve(const TopoDS_Edge& edge, Handle(Geom_Curve) & curve,
                            TopLoc_Location& location, Standard_Real& tolerance) override {
    curve = CurveOf(edge).curve;
    location.Identity();
    tolerance = Grown(BRep_Tool::Tolerance(edge));
    return Standard_True;
  }

  Standard_Boolean NewPoint(const TopoDS_Vertex& vertex, gp_Pnt& point,
                            Standard_Real& tolerance) override {
    point = gp_Pnt(Stretched(BRep_Tool::Pnt(vertex).XYZ(), factors_));
    tolerance = Grown(BRep_Tool::Tolerance(vertex));
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
    tolerance = Grown(BRep_Tool::Tolerance(vertex));
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
  double Grown(double tolerance) const { return tolerance * std::max(1.0, factors_.maxCoeff()); }

  // Curves on planes follow from those in space.
  static bool IsPlanar(const TopoDS_Face& face) {
    return !Handle(Geom_Plane)::DownCast(Untrimmed(BRep_Tool::Surface(face))).IsNull();
  }

  // Without a curve for an edge that is only a point.
  StretchedCurve CurveOf(const TopoDS_Edge& edge) const {
    double first = 0, last = 0;
    const auto curve = BRep_Tool::Curve(edge, first, last);
    if (curve.IsNull()) return {};
    return StretchCurve(curve, factors_).value_or(StretchedCurve{});
  }

  // The edge in the parameters of the stretched face.
  Handle(Geom2d_Curve) CurveOn(const TopoDS_Edge& edge, const TopoDS_Face& face) const {
    double first = 0, last = 0;
    const auto drawn = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (drawn.IsNull()) return nullptr;
    const auto basis = Untrimmed<Geom2d_Curve, Geom2d_TrimmedCurve>(drawn);
    const StretchedSurface& surface = surfaces_.Find(face);
    const StretchedCurve curve = CurveOf(edge);
    if (surface.u.IsLinear() && surface.v.IsLinear()) {
      const auto line = Handle(Geom2d_Line)::DownCast(basis);
      const auto spline = Handle(Geom2d_BSplineCurve)::DownCast(basis);
      if (!spline.IsNull()) return MovedSpline(spline, surface, curve);
      if (!line.IsNull()) {
        if (const auto moved = MovedLine(line, surface, curve); !moved.IsNull()) return moved;
      }
    }
    std::vector<double> breaks = BreaksOf(Geom2dAdaptor_Curve(drawn, first, last), surface);
    for (double& at : breaks) at = curve.scale * at + curve.shift;
    return FitCurve(
        [&](double t) -> Eigen::Vector2d {
          const gp_Pnt2d p = drawn->Value((t - curve.shift) / curve.scale);
          return {surface.u.At(p.X()), surface.v.At(p.Y())};
        },
        breaks, kFit);
  }

  // Null if its parameter would not be its length.
  static Handle(Geom2d_Curve)
      MovedLine(const Handle(Geom2d_Line) & line, const StretchedSurface& surface,
                const StretchedCurve& curve) {
    const gp_XY& direction = line->Direction().XY();
    const gp_XY along =
        gp_XY(surface.u.scale * direction.X(), surface.v.scale * direction.Y()) / curve.scale;
    if (std::abs(along.Modulus() - 1) > kSame) return nullptr;
    const gp_XY& from = line->Location().XY();
    const gp_XY moved(surface.u.At(from.X()), surface.v.At(from.Y()));
    return new Geom2d_Line(gp_Pnt2d(moved - curve.shift * along), gp_Dir2d(along));
  }

  static Handle(Geom2d_Curve)
      MovedSpline(const Handle(Geom2d_BSplineCurve) & spline, const StretchedSurface& surface,
                  const StretchedCurve& curve) {
    const auto moved = Handle(Geom2d_BSplineCurve)::DownCast(spline->Copy());
    for (int i = 1; i <= moved->NbPoles(); ++i) {
      const gp_Pnt2d pole = moved->Pole(i);
      moved->SetPole(i, gp_Pnt2d(surface.u.At(pole.X()), surface.v.At(pole.Y())));
    }
    TColStd_Array1OfReal knots = moved->Knots();
    for (double& knot : knots) knot = curve.scale * knot + curve.shift;
    moved->SetKnots(knots);
    return Handle(Geom2d_Curve)(moved);
  }

  bool Suits(const TopoDS_Edge& edge, const TopoDS_Face& face) const {
    double first = 0, last = 0;
    const auto curve = BRep_Tool::Curve(edge, first, last);
    if (curve.IsNull() != BRep_Tool::Degenerated(edge)) return false;
    if (!curve.IsNull() && !StretchCurve(curve, factors_)) return false;
    return IsPlanar(face) || !BRep_Tool::CurveOnSurface(edge, face, first, last).IsNull();
  }

  const Eigen::Vector3d factors_;
  NCollection_DataMap<TopoDS_Shape, StretchedSurface, TopTools_ShapeMapHasher> surfaces_;
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

std::string WhyNotStretched(const TopoDS_Shape& solid) {
  ExactStretch stretch(kUneven);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(solid, TopAbs_FACE, faces);
  std::vector<std::string> numbers;
  for (int i = 1; i <= faces.Extent(); ++i) {
    if (!stretch.Suits(faces(i))) numbers.push_back(absl::StrCat(i));
  }
  if (numbers.empty()) return "cannot be stretched: the kernel makes no valid solid of it";
  return absl::StrCat("cannot be stretched: ", numbers.size(), " of its ", faces.Extent(),
                      " faces (", absl::StrJoin(numbers, ", "),
                      ") are offset or end in curves that are; write them as splines");
}

}  // namespace mortise::cad
