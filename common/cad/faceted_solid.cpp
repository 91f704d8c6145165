#include "common/cad/faceted_solid.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <Eigen/Geometry>
#include <Standard_Failure.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <gp_Pln.hxx>
#include <map>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"
#include "common/mesh/shapes/flat_faces.h"

namespace mortise::cad {
namespace {

constexpr double kInPlane = 1e-7;  // m, the kernel's own tolerance

Eigen::Vector3d AreaVector(const Eigen::Matrix3Xd& places, const std::vector<int>& loop,
                           const Eigen::Vector3d& from) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector3d corner = places.col(loop[i]) - from;
    area += corner.cross(places.col(loop[(i + 1) % loop.size()]) - from) / 2;
  }
  return area;
}

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
    const auto area = [&](const std::vector<int>& loop) {
      return AreaVector(places_, loop, flat.point).dot(flat.normal);
    };
    // The outer loop runs round the largest area.
    std::stable_sort(loops.begin(), loops.end(),
                     [&](const auto& a, const auto& b) { return area(a) > area(b); });
    const gp_Pln kernel(gp_Pnt(flat.point.x(), flat.point.y(), flat.point.z()),
                        gp_Dir(flat.normal.x(), flat.normal.y(), flat.normal.z()));
    BRepBuilderAPI_MakeFace face(kernel, WireOf(loops.front()), Standard_True);
    for (std::size_t i = 1; i < loops.size(); ++i) face.Add(WireOf(loops[i]));
    return face.Face();
  }

 private:
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

// Faces that hang together by their edges: the outside of a solid, or a hollow in it.
struct Shell {
  std::vector<std::size_t> faces;
  double volume = 0;  // m³; of a hollow, negative
};

std::vector<Shell> ShellsOf(const Eigen::Matrix3Xd& places,
                            const std::vector<mesh::FlatFace>& faces) {
  boost::disjoint_sets_with_storage<> joined(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) joined.make_set(f);
  std::map<std::pair<int, int>, std::size_t> first_at;  // by edge
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const std::vector<int>& loop : faces[f].loops) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const auto edge = std::minmax({loop[i], loop[(i + 1) % loop.size()]});
        joined.union_set(f, first_at.emplace(edge, f).first->second);
      }
    }
  }
  const Eigen::Vector3d origin = places.col(0);
  std::map<std::size_t, Shell> shells;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Shell& shell = shells[joined.find_set(f)];
    shell.faces.push_back(f);
    for (const std::vector<int>& loop : faces[f].loops) {
      const Eigen::Vector3d area = AreaVector(places, loop, faces[f].point);
      shell.volume += area.dot(faces[f].point - origin) / 3;
    }
  }
  std::vector<Shell> all;
  for (auto& [root, shell] : shells) all.push_back(std::move(shell));
  return all;
}

Solid Make(const mesh::SurfaceMesh& surface, const std::vector<mesh::FlatFace>& faces,
           const std::vector<Shell>& shells, const std::vector<std::string>& face_names,
           const std::string& name) {
  FaceMaker maker(surface.vertices);
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = name;
  BRep_Builder builder;
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  for (const Shell& of_solid : shells) {
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    for (const std::size_t f : of_solid.faces) {
      const TopoDS_Face face = maker.FaceOf(faces[f]);
      builder.Add(shell, face);
      kernel->faces.push_back(face);
      kernel->face_names.push_back(face_names[static_cast<std::size_t>(faces[f].face)]);
    }
    shell.Closed(Standard_True);
    builder.Add(solid, shell);
  }
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
  const std::vector<Shell> shells = ShellsOf(surface.vertices, faces);
  const auto solids = std::count_if(shells.begin(), shells.end(),
                                    [](const Shell& shell) { return shell.volume > 0; });
  if (solids != 1) {
    return InvalidField("shape", absl::StrCat("bounds ", solids, " solids, not one"));
  }
  try {
    return Make(surface, faces, shells, face_names, name);
  } catch (const Standard_Failure& failure) {
    return InvalidField("shape", absl::StrCat("cannot be made: ", failure.GetMessageString()));
  }
}

bool IsSound(const Solid& solid) {
  try {
    return BRepCheck_Analyzer(solid.kernel().shape).IsValid();
  } catch (const Standard_Failure&) {
    return false;
  }
}

}  // namespace mortise::cad
