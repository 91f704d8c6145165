#include "common/templates/features/blend_room.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepLProp_CLProps.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <ElCLib.hxx>
#include <Geom2d_Curve.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace mortise::cad {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr int kSamples = 16;           // intervals of an edge
constexpr int kSampledAngles = 2;      // intervals, for the angle between faces
constexpr double kSharpest = 0.98;     // of a half turn; past it the strips have no end
constexpr int kUsualEdges = 3;         // that meet at a corner
constexpr double kSmoothAngle = 0.01;  // rad

double ParameterAt(const BRepAdaptor_Curve& curve, int sample, int samples) {
  const double share = static_cast<double>(sample) / samples;
  return curve.FirstParameter() + share * (curve.LastParameter() - curve.FirstParameter());
}

// From a point to the curve that an edge lies on, past its ends where that is a line or a circle.
double DistanceToCurve(const BRepAdaptor_Curve& curve, const gp_Pnt& point) {
  switch (curve.GetType()) {
    case GeomAbs_Line:
      return curve.Line().Distance(point);
    case GeomAbs_Circle: {
      const gp_Circ circle = curve.Circle();
      return point.Distance(ElCLib::Value(ElCLib::Parameter(circle, point), circle));
    }
    default: {
      double least = kInfinite;
      for (int i = 0; i <= kSamples; ++i) {
        least = std::min(least, point.Distance(curve.Value(ParameterAt(curve, i, kSamples))));
      }
      return least;
    }
  }
}

// How far an edge leads away from a curve that it begins at.
double Reach(const TopoDS_Edge& edge, const BRepAdaptor_Curve& from) {
  const BRepAdaptor_Curve curve(edge);
  double farthest = 0;
  for (int i = 0; i <= kSamples; ++i) {
    const gp_Pnt point = curve.Value(ParameterAt(curve, i, kSamples));
    farthest = std::max(farthest, DistanceToCurve(from, point));
  }
  return farthest;
}

// The least radius at which an edge bends, mm.
double LeastRadius(const BRepAdaptor_Curve& curve) {
  if (curve.GetType() == GeomAbs_Line) return kInfinite;
  if (curve.GetType() == GeomAbs_Circle) return curve.Circle().Radius();
  double sharpest = 0;
  for (int i = 0; i <= kSamples; ++i) {
    BRepLProp_CLProps properties(curve, ParameterAt(curve, i, kSamples), 2, 1e-7);
    if (!properties.IsTangentDefined()) return 0;
    sharpest = std::max(sharpest, properties.Curvature());
  }
  return sharpest > 0 ? 1 / sharpest : kInfinite;
}

// Out of the material; nothing where the surface has no normal.
std::optional<gp_Dir> NormalAt(const TopoDS_Face& face, const TopoDS_Edge& edge, double parameter) {
  double first = 0, last = 0;
  const Handle(Geom2d_Curve) on_face = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (on_face.IsNull()) return std::nullopt;
  const gp_Pnt2d place = on_face->Value(parameter);
  gp_Pnt point;
  gp_Vec along_u, along_v;
  BRepAdaptor_Surface(face, Standard_False).D1(place.X(), place.Y(), point, along_u, along_v);
  gp_Vec normal = along_u.Crossed(along_v);
  if (normal.Magnitude() < 1e-12) return std::nullopt;
  if (face.Orientation() == TopAbs_REVERSED) normal.Reverse();
  return gp_Dir(normal);
}

// How many times its radius the strips of a fillet are wide; 0 where they have no end.
double StripOfFillet(const TopoDS_Edge& edge, const BRepAdaptor_Curve& curve,
                     const TopoDS_Face& first, const TopoDS_Face& second) {
  double widest = 0;
  for (int i = 0; i <= kSampledAngles; ++i) {
    const double parameter = ParameterAt(curve, i, kSampledAngles);
    const std::optional<gp_Dir> a = NormalAt(first, edge, parameter);
    const std::optional<gp_Dir> b = NormalAt(second, edge, parameter);
    if (!a || !b) return 0;
    const double turn = a->Angle(*b);
    if (turn > kSharpest * std::numbers::pi) return 0;
    widest = std::max(widest, std::tan(turn / 2));
  }
  return widest;
}

gp_Vec TangentAt(const TopoDS_Vertex& end, const TopoDS_Edge& edge) {
  gp_Pnt point;
  gp_Vec tangent;
  BRepAdaptor_Curve(edge).D1(BRep_Tool::Parameter(end, edge), point, tangent);
  return tangent;
}

// What lies around the edges of a shape that are blended.
class Surroundings {
 public:
  Surroundings(const TopoDS_Shape& shape, const std::vector<TopoDS_Edge>& blended, BlendKind kind,
               double limit)
      : kind_(kind), limit_(limit) {
    TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of_);
    TopExp::MapShapesAndAncestors(shape, TopAbs_VERTEX, TopAbs_EDGE, edges_at_);
    TopExp::MapShapesAndAncestors(shape, TopAbs_VERTEX, TopAbs_FACE, faces_at_);
    boxes_.resize(static_cast<std::size_t>(faces_of_.Extent()));
    for (const TopoDS_Edge& edge : blended) blended_.Add(edge);
  }

  double SizeBeside(const TopoDS_Edge& edge) {
    if (!faces_of_.Contains(edge)) return 0;
    const TopTools_ListOfShape& faces = faces_of_.FindFromKey(edge);
    if (faces.Extent() != 2) return 0;
    const TopoDS_Face first = TopoDS::Face(faces.First()), second = TopoDS::Face(faces.Last());
    const BRepAdaptor_Curve curve(edge);
    const double strip =
        kind_ == BlendKind::kFillet ? StripOfFillet(edge, curve, first, second) : 1;
    if (strip <= 0) return 0;
    const double reach = limit_ * strip;
    double width = LeastRadius(curve);
    width = std::min(width, WidthOn(first, edge, curve, reach));
    width = std::min(width, WidthOn(second, edge, curve, reach));
    for (const TopoDS_Shape& end : EndsOf(edge)) {
      width = std::min(width, WidthBehind(end, edge, first, second, reach));
    }
    return width / strip;
  }

 private:
  static std::vector<TopoDS_Shape> EndsOf(const TopoDS_Edge& edge) {
    TopTools_IndexedMapOfShape found;
    TopExp::MapShapes(edge, TopAbs_VERTEX, found);
    std::vector<TopoDS_Shape> ends;
    for (int i = 1; i <= found.Extent(); ++i) ends.push_back(found(i));
    return ends;
  }

  const Bnd_Box& BoxOf(const TopoDS_Shape& edge) {
    std::optional<Bnd_Box>& box = boxes_[static_cast<std::size_t>(faces_of_.FindIndex(edge)) - 1];
    if (!box) {
      box.emplace();
      BRepBndLib::Add(edge, *box, Standard_False);
    }
    return *box;
  }

  // Infinite from `reach` on.
  static double Distance(const TopoDS_Shape& a, const Bnd_Box& box_a, const TopoDS_Shape& b,
                         const Bnd_Box& box_b, double reach) {
    if (box_a.Distance(box_b) > reach) return kInfinite;
    const BRepExtrema_DistShapeShape distance(a, b);
    if (!distance.IsDone()) return 0;
    return distance.Value() > reach ? kInfinite : distance.Value();
  }

  // The width of the strip of a face along an edge of it that is free of its other edges.
  double WidthOn(const TopoDS_Face& face, const TopoDS_Edge& edge, const BRepAdaptor_Curve& curve,
                 double reach) {
    double width = kInfinite;
    for (TopExp_Explorer others(face, TopAbs_EDGE); others.More(); others.Next()) {
      const TopoDS_Edge& other = TopoDS::Edge(others.Current());
      if (other.IsSame(edge) || BRep_Tool::Degenerated(other)) continue;
      TopoDS_Vertex common;
      if (!TopExp::CommonVertex(edge, other, common)) {
        width = std::min(width, Distance(edge, BoxOf(edge), other, BoxOf(other), reach));
      } else if (!Continues(edge, other, common)) {
        width = std::min(width, Reach(other, curve));
      }
    }
    return width;
  }

  // Whether the kernel goes on along `other` where the edge ends.
  bool Continues(const TopoDS_Edge& edge, const TopoDS_Edge& other,
                 const TopoDS_Vertex& common) const {
    if (!blended_.Contains(other)) return false;
    const gp_Vec a = TangentAt(common, edge), b = TangentAt(common, other);
    return a.Magnitude() > 0 && b.Magnitude() > 0 && a.IsParallel(b, kSmoothAngle);
  }

  // The width that is free on the faces that an edge ends at.
  double WidthBehind(const TopoDS_Shape& end, const TopoDS_Edge& edge, const TopoDS_Face& first,
                     const TopoDS_Face& second, double reach) {
    TopTools_IndexedMapOfShape meeting;
    for (const TopoDS_Shape& other : edges_at_.FindFromKey(end)) meeting.Add(other);
    if (meeting.Extent() > kUsualEdges) return 0;
    Bnd_Box place;
    place.Add(BRep_Tool::Pnt(TopoDS::Vertex(end)));
    double width = kInfinite;
    for (const TopoDS_Shape& face : faces_at_.FindFromKey(end)) {
      if (face.IsSame(first) || face.IsSame(second)) continue;
      for (TopExp_Explorer others(face, TopAbs_EDGE); others.More(); others.Next()) {
        const TopoDS_Edge& other = TopoDS::Edge(others.Current());
        if (meeting.Contains(other) || other.IsSame(edge) || BRep_Tool::Degenerated(other))
          continue;
        width = std::min(width, Distance(end, place, other, BoxOf(other), reach));
      }
    }
    return width;
  }

  const BlendKind kind_;
  const double limit_;
  TopTools_IndexedDataMapOfShapeListOfShape faces_of_, edges_at_, faces_at_;
  TopTools_IndexedMapOfShape blended_;
  std::vector<std::optional<Bnd_Box>> boxes_;  // of edges, as far as they were asked for
};

}  // namespace

BlendRoom RoomBeside(const TopoDS_Shape& shape, const std::vector<TopoDS_Edge>& edges,
                     BlendKind kind, double limit) {
  Surroundings surroundings(shape, edges, kind, limit);
  BlendRoom room;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double size = surroundings.SizeBeside(edges[i]);
    if (size >= room.size) continue;
    room = {size, i};
  }
  return room;
}

}  // namespace mortise::cad
