// Extrudes, revolves and sweeps faces with the kernel, and notes which face came from which edge.
#include "common/templates/features/feature_solids.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRepOffsetAPI_MakePipe.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cad {
namespace {

constexpr double kShortest = 1e-6;  // m
// Shapes without locations: the kernel goes through them at every look at a curve on a face, which
// makes combining an eighth slower.
constexpr Standard_Boolean kOwnGeometry = Standard_True;

bool LiesOn(const TopoDS_Edge& edge, const TopoDS_Face& face) {
  const BRepAdaptor_Curve curve(edge);
  const gp_Pnt middle = curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2);
  BRepExtrema_DistShapeShape distance(BRepBuilderAPI_MakeVertex(middle).Vertex(), face);
  return distance.IsDone() && distance.Value() < 1e-6;
}

// Turns a solid that is inside out, as the kernel makes of a face that looks against its way.
void TurnOutwards(NamedBody& body) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(body.shape, properties);
  if (properties.Mass() >= 0) return;
  body.shape.Reverse();
  for (NamedFaces& named : body.names) {
    for (TopoDS_Face& face : named.faces) face.Reverse();
  }
}

// Names the faces that `sweep` made of the edges and, unless it closes on itself, of the region. It
// gives them as they were made; they are named as the solid has them turned.
template <typename Algorithm>
NamedBody NameFaces(Algorithm& sweep, const SketchRegion& region, const std::string& feature,
                    bool has_caps) {
  NamedBody body{feature, sweep.Shape(), {}};
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(body.shape, TopAbs_FACE, faces);
  TopTools_IndexedMapOfShape unclaimed = faces;
  const auto claim = [&](const TopoDS_Shape& face, NamedFaces& named) {
    const int index = faces.FindIndex(face);
    if (index == 0) return;
    named.faces.push_back(TopoDS::Face(faces(index)));
    unclaimed.RemoveKey(face);
  };
  for (const auto& [edge, role] : region.edges) {
    NamedFaces named{{feature, kNoInstance, role}, {}, {}};
    for (const TopoDS_Shape& shape : sweep.Generated(edge)) {
      if (shape.ShapeType() == TopAbs_FACE) claim(shape, named);
    }
    body.names.push_back(std::move(named));
  }
  if (has_caps) {
    for (const auto& [role, shape] :
         {std::pair<const char*, TopoDS_Shape>("start", sweep.FirstShape()),
          {"end", sweep.LastShape()}}) {
      body.names.push_back({{feature, kNoInstance, role}, {}, {}});
      claim(shape, body.names.back());
    }
  }
  // After a full turn the kernel does not tell of which edge it made the faces that are plane.
  for (std::size_t i = 0; i < region.edges.size(); ++i) {
    if (!body.names[i].faces.empty()) continue;
    for (int k = 1; k <= unclaimed.Extent(); ++k) {
      const TopoDS_Face face = TopoDS::Face(unclaimed(k));
      if (LiesOn(region.edges[i].first, face)) body.names[i].faces.push_back(face);
    }
  }
  return body;
}

// Whether the loops lie on one side of the line, touching it at most.
bool IsOnOneSide(const std::vector<CurveLoop>& loops, const Eigen::Vector2d& point,
                 const Eigen::Vector2d& direction) {
  double least = 0, most = 0;
  for (const CurveLoop& loop : loops) {
    for (const SketchCurve& curve : loop.curves) {
      const Eigen::Matrix2Xd points = PointsAlong(curve, 33);
      for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Eigen::Vector2d off = points.col(i) - point;
        const double side = direction.x() * off.y() - direction.y() * off.x();
        least = std::min(least, side);
        most = std::max(most, side);
      }
    }
  }
  return least > -kShortest || most < kShortest;
}

SketchRegion Moved(const SketchRegion& region, const gp_Trsf& placement) {
  BRepBuilderAPI_Transform transform(region.face, placement, kOwnGeometry);
  SketchRegion moved{TopoDS::Face(transform.Shape()), {}};
  for (const auto& [edge, role] : region.edges) {
    moved.edges.emplace_back(TopoDS::Edge(transform.ModifiedShape(edge)), role);
  }
  return moved;
}

gp_Vec InSpace(const gp_Ax3& frame, const Eigen::Vector2d& vector) {
  return gp_Vec(frame.XDirection()) * vector.x() + gp_Vec(frame.YDirection()) * vector.y();
}

}  // namespace

absl::StatusOr<std::vector<NamedBody>> MakeExtrusion(const Extrude& extrude,
                                                     const std::string& feature,
                                                     const BuiltSketch& sketch,
                                                     const Numbers& numbers) {
  const double from = numbers(extrude.from), to = numbers(extrude.to);
  if (!(to - from >= kShortest)) {
    return InvalidField("extrude.to",
                        absl::StrCat("is ", to, " m, not greater than `from`, ", from, " m"));
  }
  const gp_Vec normal(sketch.frame.Direction());
  gp_Trsf offset;
  offset.SetTranslation(normal * (from * kModelScale));
  std::vector<NamedBody> solids;
  for (const SketchRegion& region : sketch.regions) {
    const SketchRegion moved = from == 0 ? region : Moved(region, offset);
    BRepPrimAPI_MakePrism prism(moved.face, normal * ((to - from) * kModelScale), kOwnGeometry);
    solids.push_back(NameFaces(prism, moved, feature, true));
  }
  return solids;
}

absl::StatusOr<std::vector<NamedBody>> MakeRevolution(const Revolve& revolve,
                                                      const std::string& feature,
                                                      const BuiltSketch& sketch,
                                                      const Numbers& numbers) {
  const Eigen::Vector2d point = numbers(revolve.axis_point);
  const Eigen::Vector2d direction = numbers(revolve.axis_direction);
  if (direction.norm() < 1e-9) return InvalidField("revolve.axis_direction", "has no length");
  if (!IsOnOneSide(sketch.loops, point, direction.normalized())) {
    return InvalidField("revolve.axis_point", "the axis goes through the sketch's profiles");
  }
  const gp_Vec origin = InSpace(sketch.frame, point * kModelScale);
  const gp_Ax1 axis(sketch.frame.Location().Translated(origin),
                    gp_Dir(InSpace(sketch.frame, direction)));
  const double angle = revolve.angle.empty() ? 2 * std::numbers::pi : numbers(revolve.angle);
  const bool full = angle > 2 * std::numbers::pi - 1e-9;
  std::vector<NamedBody> solids;
  for (const SketchRegion& region : sketch.regions) {
    if (full) {
      BRepPrimAPI_MakeRevol revolution(region.face, axis, kOwnGeometry);
      solids.push_back(NameFaces(revolution, region, feature, false));
    } else {
      BRepPrimAPI_MakeRevol revolution(region.face, axis, angle, kOwnGeometry);
      solids.push_back(NameFaces(revolution, region, feature, true));
    }
    TurnOutwards(solids.back());
  }
  return solids;
}

absl::StatusOr<std::vector<NamedBody>> MakeSweep(const Sweep&, const std::string& feature,
                                                 const BuiltSketch& sketch,
                                                 const BuiltSketch& path) {
  const CurveLoop& loop = path.loops.front();
  const Eigen::Matrix2Xd points = PointsAlong(loop.curves.front(), 1001);
  const gp_Vec start = InSpace(path.frame, points.col(0) * kModelScale);
  const gp_Vec tangent = InSpace(path.frame, (points.col(1) - points.col(0)).normalized());
  const gp_Vec normal(sketch.frame.Direction());
  const gp_Vec off(sketch.frame.Location(), path.frame.Location().Translated(start));
  if (std::abs(off.Dot(normal)) > kShortest * kModelScale) {
    return InvalidField("sweep.path", "does not begin in the plane of the sketch");
  }
  if (std::abs(tangent.Dot(normal)) < 0.1) {
    return InvalidField("sweep.path", "begins along the plane of the sketch, not out of it");
  }
  std::vector<NamedBody> solids;
  for (const SketchRegion& region : sketch.regions) {
    BRepOffsetAPI_MakePipe pipe(path.path, region.face);
    solids.push_back(NameFaces(pipe, region, feature, true));
    TurnOutwards(solids.back());
  }
  return solids;
}

absl::StatusOr<NamedBody> MakeDrill(const Hole& hole, const std::string& feature,
                                    const gp_Ax3& entry, double reach, const Numbers& numbers) {
  const double radius = numbers(hole.diameter) / 2;
  const double depth = hole.depth.empty() ? reach / kModelScale : numbers(hole.depth);
  // Half of the drill's section: x is the distance from the axis, y the height over the face.
  CurveLoop half{"drill", "", {}, false, true};
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  const auto line_to = [&](const std::string& role, double x, double y) {
    SketchCurve line;
    line.role = role;
    line.from = at;
    line.to = at = Eigen::Vector2d(x, y);
    half.curves.push_back(std::move(line));
  };
  line_to("floor_axis", 0, -depth);
  line_to("floor", radius, -depth);
  if (!hole.counterbore_diameter.empty()) {
    const double wide = numbers(hole.counterbore_diameter) / 2;
    const double step = numbers(hole.counterbore_depth);
    if (wide <= radius + kShortest) {
      return InvalidField("hole.counterbore_diameter", "is not greater than the diameter");
    }
    if (step >= depth - kShortest) {
      return InvalidField("hole.counterbore_depth", "is not less than the depth");
    }
    line_to("wall", radius, -step);
    line_to("counterbore_floor", wide, -step);
    line_to("counterbore_wall", wide, 0);
  } else if (!hole.countersink_diameter.empty()) {
    const double wide = numbers(hole.countersink_diameter) / 2;
    const double cone =
        hole.countersink_angle.empty() ? std::numbers::pi / 2 : numbers(hole.countersink_angle);
    const double step = (wide - radius) / std::tan(cone / 2);
    if (wide <= radius + kShortest) {
      return InvalidField("hole.countersink_diameter", "is not greater than the diameter");
    }
    if (step >= depth - kShortest) {
      return InvalidField("hole.countersink_angle", "makes the cone as deep as the hole");
    }
    line_to("wall", radius, -step);
    line_to("countersink", wide, 0);
  } else {
    line_to("wall", radius, 0);
  }
  line_to("opening", 0, 0);
  const gp_Dir along = entry.XDirection();
  const gp_Ax3 section(entry.Location(), along.Crossed(entry.Direction()), along);
  MORTISE_ASSIGN_OR_RETURN(const BuiltSketch sketch, BuildSketch({half}, section));
  BRepPrimAPI_MakeRevol revolution(sketch.regions.front().face,
                                   gp_Ax1(entry.Location(), entry.Direction()), kOwnGeometry);
  NamedBody drill = NameFaces(revolution, sketch.regions.front(), feature, false);
  TurnOutwards(drill);
  return drill;
}

}  // namespace mortise::cad
