// Makes half-edge meshes of triangle surfaces, for whatever walks along a surface: they say what
// lies beside what. This header brings OpenMesh, so only source files include it.
//
// Surfaces are kept and exchanged as index arrays (surface_mesh.h): they hold whole assemblies and
// faulty uploads, which no half-edge mesh can. CGAL's algorithms take a HalfedgeMesh as it is, with
// <CGAL/boost/graph/graph_traits_TriMesh_ArrayKernelT.h> included before this file; they read its
// points in double precision, but round those that they would set to single.
#pragma once

#include <Eigen/Core>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
// Needs what is above.
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

struct EigenTraits : OpenMesh::DefaultTraits {
  using Point = Eigen::Vector3d;  // m
  using Normal = Eigen::Vector3d;
};
using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<EigenTraits>;

// An edge of a surface, however many triangles meet there.
struct SurfaceEdge {
  int low = -1;      // vertices of the surface
  int high = -1;     // the same as `low` only where a triangle names a vertex twice
  int forward = 0;   // triangles that run along it from `low` to `high`
  int backward = 0;  // and those that run from `high` to `low`
  int first = -1;    // edge of the half-edge mesh: see CutSurface

  int triangles() const { return forward + backward; }
  bool IsJoined() const { return forward == 1 && backward == 1; }
};

// A half-edge mesh of any triangles, cut open where they are no oriented 2-manifold: along edges
// that two triangles do not run along once either way, and at vertices where several fans of
// triangles meet. Nothing is refused, and every cut is a border of the mesh.
//
// Faces of the mesh are the triangles, in their order, and a face's first half-edge leaves the
// triangle's first corner. Vertices of the mesh are those of the surface, in their order, and after
// them the copies that cuts made.
class CutSurface {
 public:
  // Every index must be of a vertex. O(V + T log d) with d triangles at a vertex.
  CutSurface(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles);

  const HalfedgeMesh& mesh() const { return mesh_; }

  // Returns the surface's edges by `low`, then `high`. A joined edge is the edge `first` of the
  // mesh. Any other was cut into as many edges as it has triangles, from `first` on, each with its
  // triangle at its half-edge 0.
  const std::vector<SurfaceEdge>& edges() const { return edges_; }

  // Returns the i-th of the triangles at one of the edges.
  int TriangleAt(const SurfaceEdge& edge, int i) const;

  // Returns the surface's vertex that a half-edge leaves.
  int CornerOf(OpenMesh::HalfedgeHandle halfedge) const {
    return origin_[static_cast<std::size_t>(mesh_.from_vertex_handle(halfedge).idx())];
  }

  // Returns the surface's vertex for each vertex of the mesh.
  const std::vector<int>& origin() const { return origin_; }

 private:
  std::vector<OpenMesh::HalfedgeHandle> JoinEdges(const Eigen::Matrix3Xi& triangles);
  void LinkFaces(const std::vector<OpenMesh::HalfedgeHandle>& sides);
  void LinkFan(OpenMesh::HalfedgeHandle start, OpenMesh::VertexHandle vertex);

  HalfedgeMesh mesh_;
  std::vector<SurfaceEdge> edges_;
  std::vector<int> origin_;
};

// Makes an oriented 2-manifold, closed or with borders, a half-edge mesh; triangles and vertices
// keep their order and the triangles their first corners. INVALID_ARGUMENT, "surface", with the
// places of the first faults: indices of no vertex, numbers that are not finite, triangles that
// name a vertex twice, edges with more than two triangles, neighbours that face opposite ways, and
// vertices where several fans of triangles meet.
absl::StatusOr<HalfedgeMesh> ToHalfedgeMesh(const SurfaceMesh& surface);

// Returns the vertices and triangles of a mesh that has no deleted ones, in their order, to the
// bit.
SurfaceMesh ToSurfaceMesh(const HalfedgeMesh& mesh);

}  // namespace mortise::mesh
