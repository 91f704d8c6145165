// Builds wires edge by edge over shared vertices, and faces with their holes.
#include "common/templates/features/sketch_faces.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/templates/features/named_body.h"

namespace mortise::cad {
namespace {

gp_Pnt InSpace(const gp_Ax3& frame, const Eigen::Vector2d& point) {
  return frame.Location()
      .Translated(gp_Vec(frame.XDirection()) * (point.x() * kModelScale))
      .Translated(gp_Vec(frame.YDirection()) * (point.y() * kModelScale));
}

struct BuiltWire {
  TopoDS_Wire wire;
  std::vector<std::pair<TopoDS_Edge, std::string>> edges;
};

TopoDS_Edge MakeEdge(const gp_Ax3& frame, const SketchCurve& curve, const TopoDS_Vertex& from,
                     const TopoDS_Vertex& to) {
  if (curve.kind == CurveKind::kCircle) {
    const gp_Ax2 axes(InSpace(frame, curve.center), frame.Direction(), frame.XDirection());
    return BRepBuilderAPI_MakeEdge(gp_Circ(axes, curve.radius * kModelScale)).Edge();
  }
  if (curve.kind == CurveKind::kLine) return BRepBuilderAPI_MakeEdge(from, to).Edge();
  const GC_MakeArcOfCircle arc(InSpace(frame, curve.from), InSpace(frame, curve.through),
                               InSpace(frame, curve.to));
  return BRepBuilderAPI_MakeEdge(arc.Value(), from, to).Edge();
}

BuiltWire MakeWire(const gp_Ax3& frame, const CurveLoop& loop) {
  const std::size_t count = loop.curves.size();
  std::vector<TopoDS_Vertex> vertices;
  for (const SketchCurve& curve : loop.curves) {
    vertices.push_back(BRepBuilderAPI_MakeVertex(InSpace(frame, curve.from)).Vertex());
  }
  vertices.push_back(loop.open
                         ? BRepBuilderAPI_MakeVertex(InSpace(frame, loop.curves.back().to)).Vertex()
                         : vertices.front());
  BuiltWire result;
  BRepBuilderAPI_MakeWire wire;
  for (std::size_t i = 0; i < count; ++i) {
    wire.Add(MakeEdge(frame, loop.curves[i], vertices[i], vertices[i + 1]));
    result.edges.emplace_back(wire.Edge(), loop.curves[i].role);
  }
  result.wire = wire.Wire();
  return result;
}

absl::Status Crosses(std::size_t profile, const std::string& name) {
  return InvalidField(absl::StrCat("sketch.profiles[", profile, "]"),
                      absl::StrCat("'", name, "' crosses itself, or a hole of it is not inside"));
}

absl::StatusOr<SketchRegion> MakeRegion(const std::vector<CurveLoop>& loops, std::size_t outer,
                                        const gp_Ax3& frame) {
  const auto oriented = [&](const CurveLoop& loop, bool counterclockwise) {
    BuiltWire built = MakeWire(frame, loop);
    if (loop.counterclockwise != counterclockwise) built.wire.Reverse();
    return built;
  };
  SketchRegion region;
  BuiltWire border = oriented(loops[outer], true);
  BRepBuilderAPI_MakeFace face(gp_Pln(frame), border.wire, Standard_False);
  region.edges = std::move(border.edges);
  for (const CurveLoop& loop : loops) {
    if (loop.hole_of != loops[outer].profile) continue;
    const BuiltWire hole = oriented(loop, false);
    face.Add(hole.wire);
    region.edges.insert(region.edges.end(), hole.edges.begin(), hole.edges.end());
  }
  if (!face.IsDone() || !BRepCheck_Analyzer(face.Face()).IsValid()) {
    return Crosses(outer, loops[outer].profile);
  }
  region.face = face.Face();
  return region;
}

}  // namespace

gp_Pnt KernelPoint(const Eigen::Vector3d& metres) {
  return {metres.x() * kModelScale, metres.y() * kModelScale, metres.z() * kModelScale};
}

absl::StatusOr<gp_Ax3> FrameOf(const SketchPlane& plane, const Numbers& numbers,
                               const gp_Ax3* face_frame) {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  if (plane.normal) normal = numbers(*plane.normal);
  if (face_frame != nullptr) {
    const gp_Dir& direction = face_frame->Direction();
    normal = Eigen::Vector3d(direction.X(), direction.Y(), direction.Z());
  }
  if (normal.norm() < 1e-9) return InvalidField("sketch.plane.normal", "has no length");
  normal.normalize();
  const bool along_x = std::abs(normal.x()) > 1 - 1e-6;
  Eigen::Vector3d x = along_x ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  if (plane.x_axis) x = numbers(*plane.x_axis);
  const double length = x.norm();
  x -= x.dot(normal) * normal;
  if (length < 1e-9 || x.norm() < 1e-6 * length) {
    return InvalidField("sketch.plane.x_axis", "has no length across the normal");
  }
  gp_Pnt origin = KernelPoint(numbers(plane.origin));
  if (face_frame != nullptr) {
    const gp_Vec off(face_frame->Location(), origin);
    const gp_Vec up(face_frame->Direction());
    origin.Translate(up * -off.Dot(up));
  }
  return gp_Ax3(origin, gp_Dir(normal.x(), normal.y(), normal.z()), gp_Dir(x.x(), x.y(), x.z()));
}

absl::StatusOr<BuiltSketch> BuildSketch(std::vector<CurveLoop> loops, const gp_Ax3& frame) {
  BuiltSketch sketch;
  sketch.frame = frame;
  sketch.loops = std::move(loops);
  for (std::size_t i = 0; i < sketch.loops.size(); ++i) {
    const CurveLoop& loop = sketch.loops[i];
    if (loop.curves.empty()) return Crosses(i, loop.profile);
    if (loop.open) {
      sketch.path = MakeWire(frame, loop).wire;
    } else if (loop.hole_of.empty()) {
      MORTISE_ASSIGN_OR_RETURN(SketchRegion region, MakeRegion(sketch.loops, i, frame));
      sketch.regions.push_back(std::move(region));
    }
  }
  return sketch;
}

}  // namespace mortise::cad
