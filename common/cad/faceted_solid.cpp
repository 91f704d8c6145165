#include "common/cad/faceted_solid.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRep_Builder.hxx>
#include <Eigen/Geometry>
#include <Standard_Failure.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <gp_Pln.hxx>
#include <map>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"
#include "common/mesh/flat_faces.h"

namespace mortise::cad {
namespace {

constexpr double kInPlane = 1e-7;  // m, the kernel's own tolerance

// Makes faces of loops of corners, which share edges and vertices.
class FaceMaker {
 public:
  explicit FaceMaker(const Eigen::Matrix3Xd& places) : places_(places) {
    for (const auto& place : places.colwise()) {
      vertices_.push_back(
          BRepBuilderAPI_MakeVertex(gp_Pnt(place.x(), place.y(), place.z())).Vertex());
    }
  }

  TopoDS_Face FaceOf(const mesh::FlatFace& flat) {
    std::vector<std::vector<int>> loops = flat.loops;
    // The outer loop runs round the largest area.
    std::stable_sort(loops.begin(), loops.end(), [&](const auto& a, const auto& b) {
      return AreaOf(a, flat) > AreaOf(b, flat);
    });
    const gp_Pln kernel(gp_Pnt(flat.point.x(), flat.point.y(), flat.point.z()),
                        gp_Dir(flat.normal.x(), flat.normal.y(), flat.normal.z()));
    BRepBuilderAPI_MakeFace face(kernel, WireOf(loops.front()), Standard_True);
    for (std::size_t i = 1; i < loops.size(); ++i) face.Add(WireOf(loops[i]));
    return face.Face();
  }

 private:
  double AreaOf(const std::vector<int>& loop, const mesh::FlatFace& plane) const {
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector3d from = places_.col(loop[i]) - plane.point;
      area += from.cross(places_.col(loop[(i + 1) % loop.size()]) - plane.point);
    }
    return area.dot(plane.normal);
  }

  TopoDS_Edge EdgeOf(int from, int to) {
    const auto [low, high] = std::minmax(from, to);
    TopoDS_Edge& edge = edges_[{low, high}];
    if (edge.IsNull()) {
      edge = BRepBuilderAPI_MakeEdge(vertices_[static_cast<std::size_t>(low)],
                                     vertices_[static_cast<std::size_t>(high)])
                 .Edge();
    }
    return from < to ? edge : TopoDS::Edge(edge.Reversed());
  }

  TopoDS_Wire WireOf(const std::vector<int>& loop) {
    BRep_Builder builder;
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      builder.Add(wire, EdgeOf(loop[i], loop[(i + 1) % loop.size()]));
    }
    wire.Closed(Standard_True);
    return wire;
  }

  const Eigen::Matrix3Xd& places_;
  std::vector<TopoDS_Vertex> vertices_;
  std::map<std::pair<int, int>, TopoDS_Edge> edges_;
};

Solid Make(const mesh::SurfaceMesh& surface, const std::vector<mesh::FlatFace>& faces,
           const std::vector<std::string>& face_names, const std::string& name) {
  FaceMaker maker(surface.vertices);
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = name;
  BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  for (const mesh::FlatFace& flat : faces) {
    const TopoDS_Face face = maker.FaceOf(flat);
    builder.Add(shell, face);
    kernel->faces.push_back(face);
    kernel->face_names.push_back(face_names[static_cast<std::size_t>(flat.face)]);
  }
  shell.Closed(Standard_True);
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  kernel->shape = solid;
  return Solid(std::move(kernel));
}

}  // namespace

absl::StatusOr<Solid> FacetedSolid(const mesh::SurfaceMesh& surface,
                                   const Eigen::VectorXi& triangle_face,
                                   const std::vector<std::string>& face_names,
                                   const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<mesh::FlatFace> faces,
                           mesh::FindFlatFaces(surface, triangle_face, kInPlane));
  try {
    return Make(surface, faces, face_names, name);
  } catch (const Standard_Failure& failure) {
    return InvalidField("shape", absl::StrCat("cannot be made: ", failure.GetMessageString()));
  }
}

}  // namespace mortise::cad
