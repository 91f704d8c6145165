#include "common/cad/stretch/solid_stretch.h"

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
#include <array>
#include <cmath>
#include <functional>
#include <gp_GTrsf.hxx>
#include <gp_Vec.hxx>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/cad/occt_vectors.h"
#include "common/cad/solid_box.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/stretch/fitted_curve.h"
#include "common/cad/stretch/stretched_curve.h"
#include "common/cad/stretch/stretched_surface.h"

namespace mortise::cad {
namespace {

constexpr double kSame = 1e-9;      // factors and lengths that differ by less, relatively, are one
constexpr double kFit = 1e-11;      // of a parameter
constexpr double kShortest = 1e-9;  // piece of a curve, of its length
const Eigen::Vector3d kUneven(1.25, 1, 1.5);
constexpr int kLooks = 32;             // along an edge
constexpr double kVolumeError = 1e-6;  // relative
// Relative: what a shape's triangles say of the volume in pieces is only that good for thin tubes.
// What is stretched piece by piece is exact, and so the kernel's check says most.
constexpr double kVolumeErrorInPieces = 1e-2;
constexpr double kRunsAlong = 1e-9;  // sine of an angle
constexpr double kStraight = 1e-6;   // of its length, that a straight edge is wide
constexpr int kCorrections = 20;     // of a parameter

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

// Of a surface that runs along an axis, the parameter that does: 0 for u, 1 for v; -1 for none.
int ParameterAlong(const Handle(Geom_Surface) & surface, int axis, const ParameterRange& range) {
  bool runs[2] = {true, true};
  for (const double u :
       {range.u_minimum, (range.u_minimum + range.u_maximum) / 2, range.u_maximum}) {
    for (const double v :
         {range.v_minimum, (range.v_minimum + range.v_maximum) / 2, range.v_maximum}) {
      gp_Pnt point;
      gp_Vec along[2];
      surface->D1(u, v, point, along[0], along[1]);
      for (int i = 0; i < 2; ++i) {
        Eigen::Vector3d across = ToEigen(along[i].XYZ());
        const double length = across.norm();
        across[axis] = 0;
        runs[i] &= length > 0 && across.norm() <= kRunsAlong * length;
      }
    }
  }
  return runs[1] ? 1 : runs[0] ? 0 : -1;
}

// The kernel's way to change the geometry of a solid and keep how it hangs together. Each face and
// each edge has one affine map; vertices go where the map itself takes them.
class ExactStretch : public BRepTools_Modification {
 public:
  explicit ExactStretch(const StretchMap& map) : map_(map) {}

  // Whether all of the solid can be stretched so. Must be asked first.
  bool Suits(const TopoDS_Shape& solid) {
    for (TopExp_Explorer found(solid, TopAbs_FACE); found.More(); found.Next()) {
      const TopoDS_Face face = TopoDS::Face(found.Current());
      if (!AddFace(face)) return false;
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
    surface = faces_.Find(face).surface.surface;
    location.Identity();
    tolerance = Grown(BRep_Tool::Tolerance(face));
    reverses_wires = reverses_face = Standard_False;
    return Standard_True;
  }

  Standard_Boolean NewCurve(const TopoDS_Edge& edge, Handle(Geom_Curve) & curve,
                            TopLoc_Location& location, Standard_Real& tolerance) override {
    curve = edges_.Find(edge).curve.curve;
    location.Identity();
    tolerance = Grown(BRep_Tool::Tolerance(edge));
    return Standard_True;
  }

  Standard_Boolean NewPoint(const TopoDS_Vertex& vertex, gp_Pnt& point,
                            Standard_Real& tolerance) override {
    const gp_Pnt drawn = BRep_Tool::Pnt(vertex);
    point = gp_Pnt(map_.At(0, drawn.X()), map_.At(1, drawn.Y()), map_.At(2, drawn.Z()));
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
    const StretchedCurve& curve = edges_.Find(edge).curve;
    parameter = curve.scale * BRep_Tool::Parameter(vertex, edge) + curve.shift;
    return Standard_True;
  }

  GeomAbs_Shape Continuity(const TopoDS_Edge& edge, const TopoDS_Face& one,
                           const TopoDS_Face& other, const TopoDS_Edge&, const TopoDS_Face&,
                           const TopoDS_Face&) override {
    return BRep_Tool::Continuity(edge, one, other);
  }

 private:
  struct StretchedFace {
    AffineStretch map;
    StretchedSurface surface;
    // Of each axis along which it reaches across pieces, the parameter that runs along it; else -1.
    std::array<int, 3> along = {-1, -1, -1};
  };
  // Without a curve for an edge that is only a point.
  struct StretchedEdge {
    AffineStretch map;
    StretchedCurve curve;
  };

  double Grown(double tolerance) const { return tolerance * std::max(1.0, map_.MostFactor()); }

  // In proportion there is one map for all, and nobody need measure anything.
  AffineStretch MapOf(const TopoDS_Shape& shape, SolidBox& extent) const {
    if (map_.IsInProportion()) return {map_.factors(), Eigen::Vector3d::Zero()};
    extent = BoxOf(shape, Eigen::Matrix3d::Identity());
    return map_.Of(extent.minimum, extent.maximum);
  }

  bool AddFace(const TopoDS_Face& face) {
    const Handle(Geom_Surface) drawn = BRep_Tool::Surface(face);
    const ParameterRange range = RangeOf(face);
    SolidBox extent;
    StretchedFace stretched;
    stretched.map = MapOf(face, extent);
    auto surface = StretchSurface(drawn, stretched.map.factors, range);
    if (!surface) return false;
    Move(surface->surface, stretched.map);
    stretched.surface = *std::move(surface);
    for (int axis = 0; axis < 3 && !map_.IsInProportion(); ++axis) {
      if (!map_.IsAcross(axis, extent.minimum[axis], extent.maximum[axis])) continue;
      const auto index = static_cast<std::size_t>(axis);
      if (IsPlanar(face)) {
        const auto plane = Handle(Geom_Plane)::DownCast(Untrimmed(drawn));
        if (std::abs(plane->Position().Direction().Coord(axis + 1)) > kRunsAlong) return false;
        continue;
      }
      stretched.along[index] = ParameterAlong(drawn, axis, range);
      if (stretched.along[index] < 0) return false;
    }
    faces_.Bind(face, stretched);
    return true;
  }

  template <class Geometry>
  void Move(const Handle(Geometry) & geometry, const AffineStretch& map) const {
    if (map.offsets.isZero(0)) return;
    geometry->Translate(gp_Vec(map.offsets.x(), map.offsets.y(), map.offsets.z()));
  }

  // Curves on planes follow from those in space.
  static bool IsPlanar(const TopoDS_Face& face) {
    return !Handle(Geom_Plane)::DownCast(Untrimmed(BRep_Tool::Surface(face))).IsNull();
  }

  bool Suits(const TopoDS_Edge& edge, const TopoDS_Face& face) {
    double first = 0, last = 0;
    if (!edges_.IsBound(edge)) {
      const auto curve = BRep_Tool::Curve(edge, first, last);
      if (curve.IsNull() != BRep_Tool::Degenerated(edge)) return false;
      SolidBox extent;
      StretchedEdge stretched;
      stretched.map = MapOf(edge, extent);
      if (!IsStraightAcross(extent)) return false;
      if (!curve.IsNull()) {
        auto made = StretchCurve(curve, stretched.map.factors);
        if (!made) return false;
        Move(made->curve, stretched.map);
        stretched.curve = *std::move(made);
      }
      edges_.Bind(edge, stretched);
    }
    return IsPlanar(face) || !BRep_Tool::CurveOnSurface(edge, face, first, last).IsNull();
  }

  // Whether an edge that reaches across pieces of an axis runs along it.
  bool IsStraightAcross(const SolidBox& extent) const {
    if (map_.IsInProportion()) return true;
    for (int axis = 0; axis < 3; ++axis) {
      if (!map_.IsAcross(axis, extent.minimum[axis], extent.maximum[axis])) continue;
      Eigen::Vector3d across = extent.maximum - extent.minimum;
      const double length = across[axis];
      across[axis] = 0;
      if (across.maxCoeff() > kStraight * length) return false;
    }
    return true;
  }

  // The edge in the parameters of the stretched face.
  Handle(Geom2d_Curve) CurveOn(const TopoDS_Edge& edge, const TopoDS_Face& face) const {
    double first = 0, last = 0;
    const auto drawn = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (drawn.IsNull()) return nullptr;
    const auto basis = Untrimmed<Geom2d_Curve, Geom2d_TrimmedCurve>(drawn);
    const StretchedFace& stretched = faces_.Find(face);
    const StretchedSurface& surface = stretched.surface;
    const StretchedCurve& curve = edges_.Find(edge).curve;
    const auto line = Handle(Geom2d_Line)::DownCast(basis);
    const bool is_own = IsAcross(stretched);  // moves otherwise than its face
    if (!is_own && surface.u.IsLinear() && surface.v.IsLinear()) {
      const auto spline = Handle(Geom2d_BSplineCurve)::DownCast(basis);
      if (!spline.IsNull()) return MovedSpline(spline, surface, curve);
      if (!line.IsNull()) {
        if (const auto moved = MovedLine(line, surface, curve); !moved.IsNull()) return moved;
      }
    }
    const Handle(Geom_Surface) from = BRep_Tool::Surface(face);
    const auto at = [&](double t) -> Eigen::Vector2d {
      const gp_Pnt2d p = drawn->Value((t - curve.shift) / curve.scale);
      const Eigen::Vector2d by_face(surface.u.At(p.X()), surface.v.At(p.Y()));
      return is_own ? Corrected(by_face, ToEigen(from->Value(p.X(), p.Y()).XYZ()), stretched,
                                edges_.Find(edge).map)
                    : by_face;
    };
    if (is_own && !line.IsNull()) {
      const double begin = curve.scale * first + curve.shift,
                   end = curve.scale * last + curve.shift;
      if (const auto moved = LineThrough(at, begin, end); !moved.IsNull()) return moved;
    }
    std::vector<double> breaks = BreaksOf(Geom2dAdaptor_Curve(drawn, first, last), surface);
    for (double& t : breaks) t = curve.scale * t + curve.shift;
    return FitCurve(at, breaks, kFit);
  }

  static bool IsAcross(const StretchedFace& face) {
    return std::any_of(face.along.begin(), face.along.end(), [](int along) { return along >= 0; });
  }

  // Parameters at which the stretched face is where the edge's own map takes a drawn point: along
  // what runs along an axis, from where the face's map takes it.
  static Eigen::Vector2d Corrected(Eigen::Vector2d at, const Eigen::Vector3d& drawn,
                                   const StretchedFace& face, const AffineStretch& map) {
    for (int axis = 0; axis < 3; ++axis) {
      const int along = face.along[static_cast<std::size_t>(axis)];
      if (along < 0) continue;
      const double wanted = map.factors[axis] * drawn[axis] + map.offsets[axis];
      for (int correction = 0; correction < kCorrections; ++correction) {
        gp_Pnt point;
        gp_Vec rates[2];
        face.surface.surface->D1(at[0], at[1], point, rates[0], rates[1]);
        const double missed = wanted - point.Coord(axis + 1);
        const double step = missed / rates[along].Coord(axis + 1);
        if (!std::isfinite(step)) break;
        at[along] += step;
        if (std::abs(step) <= kFit) break;
      }
    }
    return at;
  }

  // Null if they are on no line whose parameter is its length.
  static Handle(Geom2d_Curve)
      LineThrough(const std::function<Eigen::Vector2d(double)>& at, double begin, double end) {
    const Eigen::Vector2d from = at(begin), to = at(end), middle = at((begin + end) / 2);
    const Eigen::Vector2d along = (to - from) / (end - begin);
    const double size = (to - from).norm();
    if (std::abs(along.norm() - 1) > kSame || ((from + to) / 2 - middle).norm() > kSame * size) {
      return nullptr;
    }
    const Eigen::Vector2d foot = from - begin * along;
    return new Geom2d_Line(gp_Pnt2d(foot.x(), foot.y()), gp_Dir2d(along.x(), along.y()));
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

  const StretchMap map_;
  NCollection_DataMap<TopoDS_Shape, StretchedFace, TopTools_ShapeMapHasher> faces_;
  NCollection_DataMap<TopoDS_Shape, StretchedEdge, TopTools_ShapeMapHasher> edges_;
};

TopoDS_Shape General(const TopoDS_Shape& solid, const Eigen::Vector3d& factors) {
  gp_GTrsf stretch;
  for (int axis = 0; axis < 3; ++axis) stretch.SetValue(axis + 1, axis + 1, factors[axis]);
  return BRepBuilderAPI_GTransform(solid, stretch, Standard_True).Shape();
}

bool IsRight(const TopoDS_Shape& stretched, double volume, double error) {
  return !stretched.IsNull() && BRepCheck_Analyzer(stretched).IsValid() &&
         std::abs(AccurateVolume(stretched) - volume) <= error * volume;
}

// Null if there is no exact one, or not with this volume.
TopoDS_Shape Exact(const TopoDS_Shape& solid, const StretchMap& map, double volume, double error) {
  const Handle(ExactStretch) exact = new ExactStretch(map);
  if (!exact->Suits(solid)) return {};
  BRepTools_Modifier modifier(solid, exact);
  if (!modifier.IsDone()) return {};
  const TopoDS_Shape stretched = modifier.ModifiedShape(solid);
  return IsRight(stretched, volume, error) ? stretched : TopoDS_Shape();
}

}  // namespace

TopoDS_Shape StretchSolid(const TopoDS_Shape& solid, const StretchMap& map, double volume) {
  if (!map.IsInProportion()) return Exact(solid, map, volume, kVolumeErrorInPieces);
  const Eigen::Vector3d& factors = map.factors();
  if (factors.maxCoeff() - factors.minCoeff() <= kSame * factors.maxCoeff()) {
    gp_Trsf scale;
    scale.SetScale(gp_Pnt(0, 0, 0), factors[0]);
    return BRepBuilderAPI_Transform(solid, scale, Standard_True).Shape();
  }
  const double exact_volume = AccurateVolume(solid) * factors.prod();
  TopoDS_Shape stretched = Exact(solid, map, exact_volume, kVolumeError);
  if (!stretched.IsNull()) return stretched;
  stretched = General(solid, factors);
  return IsRight(stretched, exact_volume, kVolumeError) ? stretched : TopoDS_Shape();
}

std::string WhyNotStretched(const TopoDS_Shape& solid, const StretchMap& map) {
  ExactStretch stretch(map.IsInProportion() ? StretchMap(kUneven) : map);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(solid, TopAbs_FACE, faces);
  std::vector<std::string> numbers;
  for (int i = 1; i <= faces.Extent(); ++i) {
    if (!stretch.Suits(faces(i))) numbers.push_back(absl::StrCat(i));
  }
  if (numbers.empty()) return "cannot be stretched: the kernel makes no valid solid of it";
  return absl::StrCat("cannot be stretched: ", numbers.size(), " of its ", faces.Extent(),
                      " faces (", absl::StrJoin(numbers, ", "), ") ",
                      map.IsInProportion()
                          ? "are offset or end in curves that are; write them as splines"
                          : "are offset, or reach across a level without running along its axis, "
                            "or end in curves that do");
}

}  // namespace mortise::cad
