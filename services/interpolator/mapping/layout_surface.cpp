#include "services/interpolator/mapping/layout_surface.h"

#include <algorithm>
#include <numeric>

#include "common/base/errors.h"

namespace mortise::interpolator {

using OpenMesh::EdgeHandle;
using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

namespace {

std::size_t At(int index) { return static_cast<std::size_t>(index); }

template <typename Handle>
std::size_t At(Handle handle) {
  return static_cast<std::size_t>(handle.idx());
}

}  // namespace

absl::StatusOr<LayoutSurface> LayoutSurface::Create(const mesh::SurfaceMesh& surface,
                                                    const std::vector<int>& node_vertices) {
  LayoutSurface layout;
  MORTISE_ASSIGN_OR_RETURN(layout.mesh_, mesh::ToHalfedgeMesh(surface));
  layout.given_vertices_ = static_cast<int>(surface.vertices.cols());
  layout.node_vertices_ = node_vertices;
  layout.state_.assign(layout.mesh_.n_vertices(), kFree);
  for (int node = 0; node < layout.node_count(); ++node) {
    layout.state_[At(layout.node_vertex(node))] = node;
  }
  layout.directed_.assign(layout.mesh_.n_halfedges(), -1);
  layout.patch_.assign(layout.mesh_.n_faces(), -1);
  layout.origin_.resize(layout.mesh_.n_faces());
  std::iota(layout.origin_.begin(), layout.origin_.end(), 0);
  for (const HalfedgeHandle halfedge : layout.mesh_.halfedges()) {
    if (layout.mesh_.is_boundary(halfedge)) return InvalidField("surface", "it is not closed");
  }
  return layout;
}

absl::StatusOr<int> LayoutSurface::AddPath(const std::vector<int>& vertices) {
  const int path = path_count();
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const HalfedgeHandle halfedge =
        mesh_.find_halfedge(VertexHandle(vertices[i]), VertexHandle(vertices[i + 1]));
    if (!halfedge.is_valid() || Directed(halfedge) >= 0) {
      return absl::InternalError("a path does not follow free edges of its surface");
    }
    directed_[At(halfedge)] = 2 * path;
    directed_[At(mesh_.opposite_halfedge_handle(halfedge))] = 2 * path + 1;
    if (i > 0) state_[At(vertices[i])] = kOnPath;
  }
  paths_.push_back(vertices);
  return path;
}

absl::StatusOr<int> LayoutSurface::Insert(const Trace& trace) {
  std::vector<int> vertices;
  for (const TracePoint& point : trace) {
    vertices.push_back(point.vertex >= 0 ? point.vertex
                                         : Split(EdgeHandle(point.edge), point.share).idx());
  }
  return AddPath(vertices);
}

void LayoutSurface::SplitPath(int path, int after, double share) {
  std::vector<int>& vertices = paths_[At(path)];
  const HalfedgeHandle halfedge =
      mesh_.find_halfedge(VertexHandle(vertices[At(after)]), VertexHandle(vertices[At(after + 1)]));
  const EdgeHandle edge = mesh_.edge_handle(halfedge);
  const bool is_along = mesh_.halfedge_handle(edge, 0) == halfedge;
  const VertexHandle vertex = Split(edge, is_along ? share : 1 - share);
  state_[At(vertex)] = kOnPath;
  vertices.insert(vertices.begin() + after + 1, vertex.idx());
}

// Gives half of a side that was split, and the half of the face on its left, what the whole had.
void LayoutSurface::Inherit(HalfedgeHandle side, int directed, int patch, int origin) {
  directed_[At(side)] = directed;
  patch_[At(mesh_.face_handle(side))] = patch;
  origin_[At(mesh_.face_handle(side))] = origin;
}

VertexHandle LayoutSurface::Split(EdgeHandle edge, double share) {
  const HalfedgeHandle along = mesh_.halfedge_handle(edge, 0);
  const HalfedgeHandle back = mesh_.opposite_halfedge_handle(along);
  const VertexHandle from = mesh_.from_vertex_handle(along), to = mesh_.to_vertex_handle(along);
  const int along_path = Directed(along), back_path = Directed(back);
  const FaceHandle left = mesh_.face_handle(along), right = mesh_.face_handle(back);
  const int left_patch = patch(left), right_patch = patch(right);
  const int left_origin = origin(left), right_origin = origin(right);
  const VertexHandle vertex =
      mesh_.add_vertex((1 - share) * mesh_.point(from) + share * mesh_.point(to));
  mesh_.split(edge, vertex);
  state_.resize(mesh_.n_vertices(), kFree);
  directed_.resize(mesh_.n_halfedges(), -1);
  patch_.resize(mesh_.n_faces(), -1);
  origin_.resize(mesh_.n_faces(), -1);
  const HalfedgeHandle first = mesh_.find_halfedge(from, vertex);
  const HalfedgeHandle second = mesh_.find_halfedge(vertex, to);
  Inherit(first, along_path, left_patch, left_origin);
  Inherit(second, along_path, left_patch, left_origin);
  Inherit(mesh_.opposite_halfedge_handle(first), back_path, right_patch, right_origin);
  Inherit(mesh_.opposite_halfedge_handle(second), back_path, right_patch, right_origin);
  return vertex;
}

std::vector<FaceHandle> LayoutSurface::Flood(FaceHandle seed) const {
  std::vector<FaceHandle> faces = {seed};
  std::vector<bool> is_found(mesh_.n_faces(), false);
  is_found[At(seed)] = true;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (const HalfedgeHandle side : mesh_.fh_range(faces[i])) {
      if (Directed(side) >= 0) continue;
      const FaceHandle beyond = mesh_.opposite_face_handle(side);
      if (is_found[At(beyond)]) continue;
      is_found[At(beyond)] = true;
      faces.push_back(beyond);
    }
  }
  return faces;
}

void LayoutSurface::LabelPatches() {
  std::fill(patch_.begin(), patch_.end(), -1);
  patch_count_ = 0;
  for (const FaceHandle face : mesh_.faces()) {
    if (patch(face) >= 0) continue;
    for (const FaceHandle found : Flood(face)) patch_[At(found)] = patch_count_;
    ++patch_count_;
  }
}

int LayoutSurface::SplitPatch(int path) {
  const HalfedgeHandle first = FirstOf(2 * path);
  const FaceHandle right = mesh_.opposite_face_handle(first);
  const std::vector<FaceHandle> faces = Flood(mesh_.face_handle(first));
  if (std::find(faces.begin(), faces.end(), right) != faces.end()) return -1;
  for (const FaceHandle face : faces) patch_[At(face)] = patch_count_;
  return patch_count_++;
}

int LayoutSurface::NodeOf(Corner corner) const {
  if (corner < 0) return -1 - corner;
  const std::vector<int>& vertices = path(corner / 2);
  return Node(VertexHandle(corner % 2 == 0 ? vertices.front() : vertices.back()));
}

int LayoutSurface::PatchOf(Corner corner) const {
  return patch(mesh_.face_handle(StartOf(corner)));
}

HalfedgeHandle LayoutSurface::StartOf(Corner corner) const {
  if (corner >= 0) return FirstOf(corner);
  return mesh_.halfedge_handle(VertexHandle(node_vertex(-1 - corner)));
}

Corner LayoutSurface::CornerAt(HalfedgeHandle halfedge) const {
  HalfedgeHandle clockwise = halfedge;
  do {
    if (Directed(clockwise) >= 0) return Directed(clockwise);
    clockwise = mesh_.next_halfedge_handle(mesh_.opposite_halfedge_handle(clockwise));
  } while (clockwise != halfedge);
  return CornerOfLoneNode(Node(mesh_.from_vertex_handle(halfedge)));
}

std::vector<HalfedgeHandle> LayoutSurface::Fan(Corner corner) const {
  const HalfedgeHandle start = StartOf(corner);
  std::vector<HalfedgeHandle> fan;
  HalfedgeHandle halfedge = start;
  do {
    fan.push_back(halfedge);
    halfedge = mesh_.opposite_halfedge_handle(mesh_.prev_halfedge_handle(halfedge));
  } while (halfedge != start && Directed(halfedge) < 0);
  return fan;
}

HalfedgeHandle LayoutSurface::NextOnBoundary(HalfedgeHandle halfedge) const {
  HalfedgeHandle next = mesh_.next_halfedge_handle(halfedge);
  while (Directed(next) < 0) {
    next = mesh_.next_halfedge_handle(mesh_.opposite_halfedge_handle(next));
  }
  return next;
}

std::vector<int> LayoutSurface::Walk(int directed) const {
  std::vector<int> walk;
  int current = directed;
  do {
    walk.push_back(current);
    current = Directed(NextOnBoundary(LastOf(current)));
  } while (current != directed);
  return walk;
}

HalfedgeHandle LayoutSurface::FirstOf(int directed) const {
  const std::vector<int>& vertices = path(directed / 2);
  const std::size_t last = vertices.size() - 1;
  return directed % 2 == 0
             ? mesh_.find_halfedge(VertexHandle(vertices[0]), VertexHandle(vertices[1]))
             : mesh_.find_halfedge(VertexHandle(vertices[last]), VertexHandle(vertices[last - 1]));
}

HalfedgeHandle LayoutSurface::LastOf(int directed) const {
  return mesh_.opposite_halfedge_handle(FirstOf(directed ^ 1));
}

double LayoutSurface::LengthOf(int path) const {
  const std::vector<int>& vertices = this->path(path);
  double length = 0;
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    length += (Point(vertices[i + 1]) - Point(vertices[i])).norm();
  }
  return length;
}

}  // namespace mortise::interpolator
