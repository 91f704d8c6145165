#include "common/mesh/halfedge_mesh.h"

#include <algorithm>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/mesh/surface_check.h"

namespace mortise::mesh {
namespace {

using OpenMesh::EdgeHandle;
using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

constexpr std::size_t kMaxFaults = 5;  // told of one surface

// One side of a triangle, sorted to the lower of its ends.
struct Side {
  int high = -1;
  int corner = -1;  // three times its triangle, and which of its corners it leaves
  bool is_forward = false;
};

// The sides of all triangles, by their lower ends, then their higher ones, then the triangles.
// Counting brings them to their lower ends, so that only the few of one vertex are compared.
class SortedSides {
 public:
  SortedSides(const Eigen::Matrix3Xi& triangles, std::size_t vertices) : starts_(vertices + 1, 0) {
    const auto for_each_side = [&triangles](auto visit) {
      for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
        for (int k = 0; k < 3; ++k) {
          const int from = triangles(k, t), to = triangles((k + 1) % 3, t);
          visit(static_cast<std::size_t>(std::min(from, to)),
                Side{std::max(from, to), static_cast<int>(3 * t) + k, from < to});
        }
      }
    };
    for_each_side([this](std::size_t low, const Side&) { ++starts_[low + 1]; });
    for (std::size_t v = 0; v < vertices; ++v) starts_[v + 1] += starts_[v];
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    sides_.resize(static_cast<std::size_t>(triangles.size()));
    for_each_side([&](std::size_t low, const Side& side) { sides_[next[low]++] = side; });
    for (std::size_t v = 0; v < vertices; ++v) {
      std::sort(sides_.begin() + Start(v), sides_.begin() + Start(v + 1),
                [](const Side& a, const Side& b) {
                  return a.high != b.high ? a.high < b.high : a.corner < b.corner;
                });
    }
  }

  // Calls visit(low, first, last) with the sides of each edge.
  template <typename Visit>
  void ForEachEdge(const Visit& visit) const {
    for (std::size_t v = 0; v + 1 < starts_.size(); ++v) {
      auto first = sides_.begin() + Start(v);
      const auto end = sides_.begin() + Start(v + 1);
      while (first != end) {
        const auto last =
            std::find_if(first, end, [&](const Side& side) { return side.high != first->high; });
        visit(static_cast<int>(v), first, last);
        first = last;
      }
    }
  }

 private:
  std::ptrdiff_t Start(std::size_t vertex) const {
    return static_cast<std::ptrdiff_t>(starts_[vertex]);
  }

  std::vector<std::size_t> starts_;  // of each vertex, and the end
  std::vector<Side> sides_;
};

}  // namespace

CutSurface::CutSurface(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles) {
  mesh_.resize(static_cast<std::size_t>(vertices.cols()), 0, 0);
  origin_.resize(static_cast<std::size_t>(vertices.cols()));
  for (int v = 0; v < static_cast<int>(vertices.cols()); ++v) {
    mesh_.set_point(VertexHandle(v), vertices.col(v));
    origin_[static_cast<std::size_t>(v)] = v;
  }
  const std::vector<HalfedgeHandle> sides = JoinEdges(triangles);
  LinkFaces(sides);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const HalfedgeHandle start = sides[static_cast<std::size_t>(3 * t + k)];
      if (mesh_.from_vertex_handle(start).is_valid()) continue;
      VertexHandle vertex(triangles(k, t));
      // It has a fan already: another one gets a copy.
      if (mesh_.halfedge_handle(vertex).is_valid()) {
        vertex = mesh_.add_vertex(vertices.col(triangles(k, t)));
        origin_.push_back(triangles(k, t));
      }
      LinkFan(start, vertex);
    }
  }
}

// Gives every side of a triangle its half-edge, in the order of the sides.
std::vector<HalfedgeHandle> CutSurface::JoinEdges(const Eigen::Matrix3Xi& triangles) {
  std::vector<HalfedgeHandle> halfedges(static_cast<std::size_t>(triangles.size()));
  edges_.reserve(halfedges.size() / 2);
  int next = 0;
  SortedSides(triangles, mesh_.n_vertices())
      .ForEachEdge([&](int low, const auto first, const auto last) {
        SurfaceEdge edge{.low = low, .high = first->high, .first = next};
        for (auto side = first; side != last; ++side) {
          ++(side->is_forward ? edge.forward : edge.backward);
        }
        int halfedge = 2 * next;
        for (auto side = first; side != last; ++side) {
          halfedges[static_cast<std::size_t>(side->corner)] = HalfedgeHandle(halfedge);
          halfedge += edge.IsJoined() ? 1 : 2;
        }
        next = halfedge / 2;
        edges_.push_back(edge);
      });
  mesh_.resize(mesh_.n_vertices(), static_cast<std::size_t>(next), halfedges.size() / 3);
  return halfedges;
}

void CutSurface::LinkFaces(const std::vector<HalfedgeHandle>& sides) {
  for (std::size_t corner = 0; corner < sides.size(); ++corner) {
    const FaceHandle face(static_cast<int>(corner / 3));
    const std::size_t first = corner / 3 * 3;
    if (corner == first) mesh_.set_halfedge_handle(face, sides[corner]);
    mesh_.set_face_handle(sides[corner], face);
    mesh_.set_next_halfedge_handle(sides[corner], sides[first + (corner + 1 - first) % 3]);
  }
}

// Lets all half-edges of the fan of triangles around the origin of `start` end or begin in
// `vertex`, and joins the two borders of a fan that does not close.
void CutSurface::LinkFan(HalfedgeHandle start, VertexHandle vertex) {
  HalfedgeHandle last = start;
  do {
    mesh_.set_vertex_handle(mesh_.prev_halfedge_handle(last), vertex);
    last = mesh_.ccw_rotated_halfedge_handle(last);
  } while (last != start && !mesh_.is_boundary(last));
  mesh_.set_halfedge_handle(vertex, last);
  if (last == start) return;
  HalfedgeHandle first = start;
  while (!mesh_.is_boundary(mesh_.opposite_halfedge_handle(first))) {
    first = mesh_.cw_rotated_halfedge_handle(first);
    mesh_.set_vertex_handle(mesh_.prev_halfedge_handle(first), vertex);
  }
  const HalfedgeHandle incoming = mesh_.opposite_halfedge_handle(first);
  mesh_.set_vertex_handle(incoming, vertex);
  mesh_.set_next_halfedge_handle(incoming, last);
}

int CutSurface::TriangleAt(const SurfaceEdge& edge, int i) const {
  const int halfedge = edge.IsJoined() ? 2 * edge.first + i : 2 * (edge.first + i);
  return mesh_.face_handle(HalfedgeHandle(halfedge)).idx();
}

namespace {

// What keeps a surface from being an oriented 2-manifold with borders.
std::vector<SurfaceFault> FaultsOf(const SurfaceMesh& surface, const CutSurface& cut) {
  using Kind = SurfaceFault::Kind;
  std::vector<SurfaceFault> faults;
  const auto add = [&faults](const SurfaceFault& fault) {
    if (faults.size() < kMaxFaults) faults.push_back(fault);
  };
  for (const auto& corners : surface.triangles.colwise()) {
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) continue;
    add(FaultAt(Kind::kDegenerate, surface.vertices.col(corners[0]),
                "a triangle names a vertex twice"));
  }
  for (const SurfaceEdge& edge : cut.edges()) {
    if (edge.triangles() == 1) continue;
    if (const auto fault = FaultAt(edge, surface.vertices)) add(*fault);
  }
  // Cutting along edges makes copies too: those faults say so already.
  if (!faults.empty()) return faults;
  for (auto copy = cut.origin().begin() + surface.vertices.cols(); copy != cut.origin().end();
       ++copy) {
    add(FaultAt(Kind::kPinched, surface.vertices.col(*copy),
                "the surface meets itself in a single vertex"));
  }
  return faults;
}

}  // namespace

absl::StatusOr<HalfedgeMesh> ToHalfedgeMesh(const SurfaceMesh& surface) {
  std::vector<SurfaceFault> faults = CheckNumbers(surface.vertices, surface.triangles);
  if (faults.empty()) {
    const CutSurface cut(surface.vertices, surface.triangles);
    faults = FaultsOf(surface, cut);
    if (faults.empty()) return cut.mesh();
  }
  std::vector<FieldViolation> violations;
  for (const SurfaceFault& fault : faults) violations.push_back({"surface", fault.message});
  return InvalidFields(violations);
}

SurfaceMesh ToSurfaceMesh(const HalfedgeMesh& mesh) {
  SurfaceMesh surface;
  surface.vertices.resize(3, static_cast<Eigen::Index>(mesh.n_vertices()));
  for (const VertexHandle vertex : mesh.all_vertices()) {
    surface.vertices.col(vertex.idx()) = mesh.point(vertex);
  }
  surface.triangles.resize(3, static_cast<Eigen::Index>(mesh.n_faces()));
  for (const FaceHandle face : mesh.all_faces()) {
    HalfedgeHandle halfedge = mesh.halfedge_handle(face);
    for (int k = 0; k < 3; ++k) {
      surface.triangles(k, face.idx()) = mesh.from_vertex_handle(halfedge).idx();
      halfedge = mesh.next_halfedge_handle(halfedge);
    }
  }
  return surface;
}

}  // namespace mortise::mesh
