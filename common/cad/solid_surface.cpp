// Triangulates a solid with the kernel's mesher and joins the faces at their edges.
#include "common/cad/solid_surface.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <NCollection_DataMap.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

// Collects triangles face by face. Points are shared by what the solid is made of, not by where
// they are: a vertex is one point, and the points along an edge are those of both its faces.
class Joiner {
 public:
  absl::Status Append(const TopoDS_Face& face, int index) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull()) return KernelFailure("triangulating the solid", "a face has no triangles");
    std::vector<int> nodes(static_cast<std::size_t>(mesh->NbNodes()) + 1, -1);
    for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) {
      const Handle(Poly_PolygonOnTriangulation) polygon =
          BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(edge.Current()), mesh, location);
      if (polygon.IsNull())
        return KernelFailure("triangulating the solid", "an edge has no points");
      JoinEdge(TopoDS::Edge(edge.Current()), *mesh, location, *polygon, nodes);
    }
    for (int i = 1; i <= mesh->NbNodes(); ++i) {
      int& point = nodes[static_cast<std::size_t>(i)];
      if (point < 0) point = Add(mesh->Node(i).Transformed(location.Transformation()));
    }
    for (int i = 1; i <= mesh->NbTriangles(); ++i) {
      int a = 0, b = 0, c = 0;
      mesh->Triangle(i).Get(a, b, c);
      if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
      const Eigen::Vector3i triangle(nodes[static_cast<std::size_t>(a)],
                                     nodes[static_cast<std::size_t>(b)],
                                     nodes[static_cast<std::size_t>(c)]);
      // At the apex of a cone, whose edge there is a single point.
      if (triangle(0) == triangle(1) || triangle(1) == triangle(2) || triangle(2) == triangle(0)) {
        continue;
      }
      triangles.push_back(triangle);
      faces.push_back(index);
    }
    return absl::OkStatus();
  }

  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> faces;  // of each triangle

 private:
  int Add(const gp_Pnt& point) {
    points.push_back({point.X(), point.Y(), point.Z()});
    return static_cast<int>(points.size()) - 1;
  }

  int PointOf(const TopoDS_Vertex& vertex) {
    const int* known = vertices_.Seek(vertex);
    if (known != nullptr) return *known;
    const int index = Add(BRep_Tool::Pnt(vertex));
    vertices_.Bind(vertex, index);
    return index;
  }

  // Gives the nodes of a face's triangulation that lie on the edge the points of the edge.
  void JoinEdge(const TopoDS_Edge& edge, const Poly_Triangulation& mesh,
                const TopLoc_Location& location, const Poly_PolygonOnTriangulation& polygon,
                std::vector<int>& nodes) {
    const int count = polygon.NbNodes();
    std::vector<int>& along = edges_[edges_by_shape_.Add(edge)];
    if (along.empty()) {
      const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
      along.push_back(PointOf(TopExp::FirstVertex(forward)));
      for (int i = 2; i < count; ++i) {
        along.push_back(
            BRep_Tool::Degenerated(edge)
                ? along.front()
                : Add(mesh.Node(polygon.Node(i)).Transformed(location.Transformation())));
      }
      along.push_back(PointOf(TopExp::LastVertex(forward)));
    }
    for (int i = 1; i <= std::min(count, static_cast<int>(along.size())); ++i) {
      nodes[static_cast<std::size_t>(polygon.Node(i))] = along[static_cast<std::size_t>(i) - 1];
    }
  }

  NCollection_DataMap<TopoDS_Shape, int, TopTools_ShapeMapHasher> vertices_;
  TopTools_IndexedMapOfShape edges_by_shape_;
  std::map<int, std::vector<int>> edges_;  // points along each edge
};

// Every edge has as many triangles on one side as on the other.
bool IsClosed(const std::vector<Eigen::Vector3i>& triangles) {
  std::map<std::pair<int, int>, int> balance;
  for (const Eigen::Vector3i& corners : triangles) {
    for (int i = 0; i < 3; ++i) {
      const int from = corners(i), to = corners((i + 1) % 3);
      balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  for (const auto& [edge, sum] : balance) {
    if (sum != 0) return false;
  }
  return true;
}

double DeflectionFor(const Solid& solid, const SurfaceOptions& options) {
  Bnd_Box box;
  BRepBndLib::Add(solid.kernel().shape, box);
  const double diagonal = box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
  return std::max(options.deflection, options.relative_deflection * diagonal);
}

absl::StatusOr<mesh::AssemblySurface> Triangulate(const Solid& solid,
                                                  const SurfaceOptions& options) {
  // The kernel keeps triangles in the shape, which others may be using: work on a copy.
  BRepBuilderAPI_Copy copy(solid.kernel().shape, Standard_False, Standard_False);
  BRepMesh_IncrementalMesh mesher(copy.Shape(), DeflectionFor(solid, options), Standard_False,
                                  options.angle, Standard_False);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(copy.Shape(), TopAbs_FACE, faces);
  Joiner joiner;
  mesh::AssemblySurface surface;
  for (std::size_t i = 0; i < solid.kernel().faces.size(); ++i) {
    // As it is turned in the solid; ModifiedShape does not tell that.
    const int index = faces.FindIndex(copy.ModifiedShape(solid.kernel().faces[i]));
    MORTISE_RETURN_IF_ERROR(joiner.Append(TopoDS::Face(faces(index)), static_cast<int>(i)));
    surface.faces.push_back({-1, 0, {{0, solid.face_names()[i]}}});
  }
  if (!IsClosed(joiner.triangles)) {
    return KernelFailure("triangulating the solid", "the triangles leave a gap");
  }
  surface.vertices.resize(3, static_cast<Eigen::Index>(joiner.points.size()));
  for (std::size_t i = 0; i < joiner.points.size(); ++i) {
    surface.vertices.col(static_cast<Eigen::Index>(i)) = joiner.points[i];
  }
  const auto count = static_cast<Eigen::Index>(joiner.triangles.size());
  surface.triangles.resize(3, count);
  surface.triangle_face.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    surface.triangles.col(i) = joiner.triangles[static_cast<std::size_t>(i)];
    surface.triangle_face(i) = joiner.faces[static_cast<std::size_t>(i)];
  }
  surface.part_interior.resize(3, 0);
  surface.part_names = {solid.name()};
  return surface;
}

}  // namespace

absl::StatusOr<mesh::AssemblySurface> SurfaceOf(const Solid& solid, const SurfaceOptions& options) {
  if (!(options.deflection >= 1e-7 && options.deflection <= 1e3)) {
    return InvalidField("deflection", "is not a length");
  }
  if (!(options.relative_deflection >= 0 && options.relative_deflection < 1)) {
    return InvalidField("relative_deflection", "must be at least 0 and less than 1");
  }
  if (!(options.angle >= 1e-3 && options.angle <= 3)) return InvalidField("angle", "is no angle");
  try {
    return Triangulate(solid, options);
  } catch (const Standard_Failure& failure) {
    return KernelFailure("triangulating the solid", failure.GetMessageString());
  }
}

double SurfaceArea(const Solid& solid) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(solid.kernel().shape, properties);
  return properties.Mass();
}

}  // namespace mortise::cad
