// Joins the kernel's triangulations of faces at what the faces share. For cad alone: it
// brings Open CASCADE.
#pragma once

#include <NCollection_DataMap.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <map>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::cad {

// Collects triangles face by face. Points are shared by what the solids are made of, not by where
// they are: a vertex is one point, and the points along an edge are those of all its faces.
class TriangleJoiner {
 public:
  // Appends the triangles of a face that has been triangulated, counter-clockwise seen from where
  // the face points. Returns the point of each node of its triangulation, from 1. INTERNAL if the
  // kernel made none, or divided an edge otherwise than for the faces before.
  absl::StatusOr<std::vector<int>> Append(const TopoDS_Face& face, int index);

  // Moves points, triangles and the index of each triangle's face into `surface`.
  void MoveTo(mesh::AssemblySurface& surface) const;

 private:
  int Add(const gp_Pnt& point);
  int PointOf(const TopoDS_Vertex& vertex);
  absl::Status JoinEdge(const TopoDS_Edge& edge, const Poly_Triangulation& mesh,
                        const TopLoc_Location& location, const Poly_PolygonOnTriangulation& polygon,
                        std::vector<int>& nodes);
  void SplitAtLoneVertices(const TopoDS_Face& face, std::size_t first);
  void SplitAt(int point, std::size_t first);
  void SplitSide(std::size_t triangle, int side, int point);

  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3i> triangles_;
  std::vector<int> faces_;  // of each triangle
  NCollection_DataMap<TopoDS_Shape, int, TopTools_ShapeMapHasher> vertices_;
  TopTools_IndexedMapOfShape edges_by_shape_;
  std::map<int, std::vector<int>> edges_;  // points along each edge
};

}  // namespace mortise::cad
