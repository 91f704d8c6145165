#include "services/interpolator/mapping/control_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/halfedge_mesh.h"

namespace mortise::interpolator {
namespace {

using OpenMesh::EdgeHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

constexpr double kAtVertex = 0.05;  // of an edge
constexpr double kFarthest = 0.1;   // of the diagonal, that a point may be off the surface
constexpr double kStray = 0.05;     // of a path: so far off it an edge counts twice its length

// Returns the nearest share of the line from `a` to `b`.
double ShareOf(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double square = (b - a).squaredNorm();
  return square > 0 ? std::clamp((point - a).dot(b - a) / square, 0.0, 1.0) : 0;
}

double DistanceFromWay(const Eigen::Vector3d& point, const Eigen::Matrix3Xd& way) {
  double distance = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i + 1 < way.cols(); ++i) {
    const Eigen::Vector3d a = way.col(i), b = way.col(i + 1);
    const double share = ShareOf(point, a, b);
    distance = std::min(distance, ((1 - share) * a + share * b - point).norm());
  }
  return distance;
}

double LengthOf(const Eigen::Matrix3Xd& way) {
  double length = 0;
  for (Eigen::Index i = 0; i + 1 < way.cols(); ++i) length += (way.col(i + 1) - way.col(i)).norm();
  return length;
}

class Placement {
 public:
  explicit Placement(mesh::HalfedgeMesh mesh) : mesh_(std::move(mesh)), origin_(mesh_.n_faces()) {
    std::iota(origin_.begin(), origin_.end(), 0);
    Eigen::AlignedBox3d box;
    for (const VertexHandle vertex : mesh_.vertices()) box.extend(mesh_.point(vertex));
    farthest_ = kFarthest * box.diagonal().norm();
  }

  // Returns the vertex at the place of the surface's edges that is nearest, or −1. All edges are
  // looked at: the nearest vertex may be of another edge where triangles are long.
  int Place(const Eigen::Vector3d& point) {
    EdgeHandle edge;
    double share = 0, off = farthest_;
    for (const EdgeHandle candidate : mesh_.edges()) {
      const auto [a, b] = EndsOf(candidate);
      const double at = ShareOf(point, mesh_.point(a), mesh_.point(b));
      const double distance = ((1 - at) * mesh_.point(a) + at * mesh_.point(b) - point).norm();
      if (distance >= off) continue;
      off = distance;
      edge = candidate;
      share = at;
    }
    if (!edge.is_valid()) return -1;
    const auto [from, to] = EndsOf(edge);
    VertexHandle place;
    if (share < kAtVertex) place = from;
    if (share > 1 - kAtVertex) place = to;
    if (!place.is_valid()) place = Split(edge, share);
    return taken_.insert(place.idx()).second ? place.idx() : -1;
  }

  // Returns the vertices along edges near a way, which no other path or point may have; empty if
  // there are none.
  std::vector<int> Follow(int from, int to, const Eigen::Matrix3Xd& way) {
    const double stray = kStray * LengthOf(way);
    std::unordered_map<int, std::pair<double, int>> reached = {{from, {0, -1}}};
    std::vector<std::pair<double, int>> queue = {{0, from}};
    while (!queue.empty()) {
      std::pop_heap(queue.begin(), queue.end(), std::greater<>());
      const auto [cost, vertex] = queue.back();
      queue.pop_back();
      if (vertex == to) return Trace(reached, to);
      if (cost > reached.at(vertex).first) continue;
      for (const HalfedgeHandle halfedge : mesh_.voh_range(VertexHandle(vertex))) {
        const int next = mesh_.to_vertex_handle(halfedge).idx();
        if (next != to && taken_.count(next) > 0) continue;
        const EdgeHandle edge = mesh_.edge_handle(halfedge);
        if (edges_.count(edge.idx()) > 0) continue;
        const double sum = cost + CostOf(vertex, next, way, stray);
        const auto [entry, is_new] = reached.try_emplace(next, sum, vertex);
        if (!is_new && sum >= entry->second.first) continue;
        entry->second = {sum, vertex};
        queue.emplace_back(sum, next);
        std::push_heap(queue.begin(), queue.end(), std::greater<>());
      }
    }
    return {};
  }

  mesh::SurfaceMesh Surface() const { return mesh::ToSurfaceMesh(mesh_); }
  const std::vector<int>& origin() const { return origin_; }

 private:
  VertexHandle Split(EdgeHandle edge, double share) {
    const auto [from, to] = EndsOf(edge);
    const HalfedgeHandle along = mesh_.halfedge_handle(edge, 0);
    const int left = OriginOf(along), right = OriginOf(mesh_.opposite_halfedge_handle(along));
    const VertexHandle vertex =
        mesh_.add_vertex((1 - share) * mesh_.point(from) + share * mesh_.point(to));
    mesh_.split(edge, vertex);
    origin_.resize(mesh_.n_faces());
    for (const HalfedgeHandle half :
         {mesh_.find_halfedge(from, vertex), mesh_.find_halfedge(vertex, to)}) {
      OriginOf(half) = left;
      OriginOf(mesh_.opposite_halfedge_handle(half)) = right;
    }
    return vertex;
  }

  // Of the face on the left of a half-edge.
  int& OriginOf(HalfedgeHandle halfedge) {
    return origin_[static_cast<std::size_t>(mesh_.face_handle(halfedge).idx())];
  }

  std::pair<VertexHandle, VertexHandle> EndsOf(EdgeHandle edge) const {
    const HalfedgeHandle along = mesh_.halfedge_handle(edge, 0);
    return {mesh_.from_vertex_handle(along), mesh_.to_vertex_handle(along)};
  }

  double CostOf(int from, int to, const Eigen::Matrix3Xd& way, double stray) const {
    const Eigen::Vector3d a = mesh_.point(VertexHandle(from)), b = mesh_.point(VertexHandle(to));
    const double off = (DistanceFromWay((a + b) / 2, way) + DistanceFromWay(b, way)) / 2 / stray;
    return (b - a).norm() * (1 + off * off);
  }

  std::vector<int> Trace(const std::unordered_map<int, std::pair<double, int>>& reached, int to) {
    std::vector<int> vertices;
    for (int vertex = to; vertex >= 0; vertex = reached.at(vertex).second) {
      if (!vertices.empty()) {
        const HalfedgeHandle side =
            mesh_.find_halfedge(VertexHandle(vertex), VertexHandle(vertices.back()));
        edges_.insert(mesh_.edge_handle(side).idx());
      }
      vertices.push_back(vertex);
      taken_.insert(vertex);
    }
    std::reverse(vertices.begin(), vertices.end());
    return vertices;
  }

  mesh::HalfedgeMesh mesh_;
  std::vector<int> origin_;  // of each face: the triangle given that it is a piece of
  double farthest_ = 0;      // m
  std::set<int> taken_;      // vertices of points and paths
  std::set<int> edges_;      // of paths
};

absl::Status Check(const mesh::ControlVariables& variables) {
  const auto count = static_cast<int>(variables.points.size());
  for (std::size_t i = 0; i < variables.points.size(); ++i) {
    if (variables.points[i].position.allFinite()) continue;
    return InvalidField(absl::StrCat("variables.points[", i, "].position"), "is not finite");
  }
  for (std::size_t i = 0; i < variables.paths.size(); ++i) {
    const mesh::ControlVariables::Path& path = variables.paths[i];
    const bool has_ends = path.from >= 0 && path.from < count && path.to >= 0 && path.to < count;
    if (has_ends && path.way.cols() >= 2 && path.way.allFinite()) continue;
    return InvalidField(absl::StrCat("variables.paths[", i, "]"),
                        "its ends are no points, or its way is none");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<MarkedSurface> PlaceControlVariables(const mesh::SurfaceMesh& surface,
                                                    const mesh::ControlVariables& variables) {
  MORTISE_RETURN_IF_ERROR(Check(variables));
  MORTISE_ASSIGN_OR_RETURN(mesh::HalfedgeMesh mesh, mesh::ToHalfedgeMesh(surface));
  for (const HalfedgeHandle halfedge : mesh.halfedges()) {
    if (mesh.is_boundary(halfedge)) return InvalidField("surface", "it is not closed");
  }
  if (mesh.n_faces() == 0) return InvalidField("surface", "it has no triangles");
  Placement placement(std::move(mesh));
  MarkedSurface marked;
  std::vector<int> vertices;
  for (const mesh::ControlVariables::Point& point : variables.points) {
    vertices.push_back(placement.Place(point.position));
    if (vertices.back() >= 0) marked.points.push_back({point.name, vertices.back()});
  }
  for (const mesh::ControlVariables::Path& path : variables.paths) {
    const int from = vertices[static_cast<std::size_t>(path.from)];
    const int to = vertices[static_cast<std::size_t>(path.to)];
    if (from < 0 || to < 0 || from == to) continue;
    std::vector<int> way = placement.Follow(from, to, path.way);
    if (!way.empty()) marked.paths.push_back({path.edge, std::move(way)});
  }
  marked.surface = placement.Surface();
  marked.origin = placement.origin();
  return marked;
}

}  // namespace mortise::interpolator
