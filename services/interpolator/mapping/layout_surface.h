// A surface on which a patch layout is drawn: nodes at vertices, paths along edges, which are split
// where paths cross them. Private to this folder: it brings OpenMesh.
//
// A path has two directed paths: 2p runs from its first vertex to its last, 2p + 1 back. What lies
// between two paths that follow each other around a node is a corner. It is known by the directed
// path that leaves the node with the corner's patch on its left, or, of a node without paths, as
// −1 − node. Corners of the same number correspond on two surfaces with the same layout.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/mesh/halfedge_mesh.h"

namespace mortise::interpolator {

// A vertex that a path goes through, or an edge that it crosses.
struct TracePoint {
  int vertex = -1;   // or
  int edge = -1;     // an edge of the mesh,
  double share = 0;  // this far from the start of its half-edge 0
};
using Trace = std::vector<TracePoint>;

using Corner = int;
inline Corner CornerOfLoneNode(int node) { return -1 - node; }

class LayoutSurface {
 public:
  // INVALID_ARGUMENT, "surface", unless it is closed, oriented and nowhere pinched.
  static absl::StatusOr<LayoutSurface> Create(const mesh::SurfaceMesh& surface,
                                              const std::vector<int>& node_vertices);

  const mesh::HalfedgeMesh& mesh() const { return mesh_; }
  int given_vertices() const { return given_vertices_; }

  // Draws a path along edges, and returns its number. INTERNAL if an edge is missing or taken.
  absl::StatusOr<int> AddPath(const std::vector<int>& vertices);

  // Splits the edges that are crossed, and draws the path.
  absl::StatusOr<int> Insert(const Trace& trace);

  // Splits an edge of a path, `after` vertices behind its start, `share` along it.
  void SplitPath(int path, int after, double share);

  // Labels the patches anew: what paths enclose.
  void LabelPatches();

  // Labels what lies left of a path as a patch of its own, and returns its number; −1 if that is
  // all of the patch that the path is in.
  int SplitPatch(int path);

  int path_count() const { return static_cast<int>(paths_.size()); }
  int patch_count() const { return patch_count_; }
  int node_count() const { return static_cast<int>(node_vertices_.size()); }
  int node_vertex(int node) const { return node_vertices_[static_cast<std::size_t>(node)]; }
  const std::vector<int>& path(int path) const { return paths_[static_cast<std::size_t>(path)]; }
  int patch(OpenMesh::FaceHandle face) const {
    return patch_[static_cast<std::size_t>(face.idx())];
  }
  int origin(OpenMesh::FaceHandle face) const {
    return origin_[static_cast<std::size_t>(face.idx())];
  }

  // Returns the directed path that a half-edge belongs to, or −1.
  int Directed(OpenMesh::HalfedgeHandle halfedge) const {
    return directed_[static_cast<std::size_t>(halfedge.idx())];
  }
  bool IsFree(OpenMesh::VertexHandle vertex) const {
    return state_[static_cast<std::size_t>(vertex.idx())] == kFree;
  }
  // Returns the node at a vertex, or a negative number.
  int Node(OpenMesh::VertexHandle vertex) const {
    return state_[static_cast<std::size_t>(vertex.idx())];
  }

  int NodeOf(Corner corner) const;
  int PatchOf(Corner corner) const;

  // Returns the half-edge of the mesh from which the corner is counted, counter-clockwise.
  OpenMesh::HalfedgeHandle StartOf(Corner corner) const;

  // Returns the corner that a half-edge which leaves a node lies in, or begins.
  Corner CornerAt(OpenMesh::HalfedgeHandle halfedge) const;

  // Returns the half-edges that leave a corner's node within it, counter-clockwise, with StartOf.
  std::vector<OpenMesh::HalfedgeHandle> Fan(Corner corner) const;

  // Returns the half-edge of a path that follows this one around the patch on its left.
  OpenMesh::HalfedgeHandle NextOnBoundary(OpenMesh::HalfedgeHandle halfedge) const;

  // Returns the directed paths around the patch on the left of `directed`, beginning with it.
  std::vector<int> Walk(int directed) const;

  // Returns the first half-edge of a directed path.
  OpenMesh::HalfedgeHandle FirstOf(int directed) const;

  double LengthOf(int path) const;

  Eigen::Vector3d Point(int vertex) const { return mesh_.point(OpenMesh::VertexHandle(vertex)); }

 private:
  static constexpr int kFree = -1;
  static constexpr int kOnPath = -2;

  LayoutSurface() = default;
  OpenMesh::VertexHandle Split(OpenMesh::EdgeHandle edge, double share);
  OpenMesh::HalfedgeHandle LastOf(int directed) const;
  void Inherit(OpenMesh::HalfedgeHandle side, int directed, int patch, int origin);
  std::vector<OpenMesh::FaceHandle> Flood(OpenMesh::FaceHandle seed) const;

  mesh::HalfedgeMesh mesh_;
  int given_vertices_ = 0;
  int patch_count_ = 0;
  std::vector<int> node_vertices_;
  std::vector<std::vector<int>> paths_;  // vertices
  std::vector<int> state_;               // of vertices: node, or one of the above
  std::vector<int> directed_;            // of half-edges
  std::vector<int> patch_;               // of faces
  std::vector<int> origin_;              // of faces: the triangle given that it is a piece of
};

}  // namespace mortise::interpolator
