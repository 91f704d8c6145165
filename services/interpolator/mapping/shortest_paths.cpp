#include "services/interpolator/mapping/shortest_paths.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace mortise::interpolator {

using OpenMesh::EdgeHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

namespace {

constexpr double kMargin = 0.05;  // of an edge, that crossings keep from its ends
constexpr int kMaximumSweeps = 400;
constexpr double kStill = 1e-6;  // of an edge

// Returns how far along the line from `a` to `b` the shortest way from `p` to `q` crosses it when
// both sides are unfolded into one plane, as a share of the line.
double Crossing(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& p,
                const Eigen::Vector3d& q) {
  const double length = (b - a).norm();
  const Eigen::Vector3d direction = (b - a) / length;
  const double along_p = (p - a).dot(direction), along_q = (q - a).dot(direction);
  const double off_p = (p - a - along_p * direction).norm();
  const double off_q = (q - a - along_q * direction).norm();
  if (off_p + off_q <= 0) return 0.5;
  return (along_p * off_q + along_q * off_p) / (off_p + off_q) / length;
}

}  // namespace

ShortestPaths::ShortestPaths(const LayoutSurface& surface, Corner from, double limit,
                             SearchSpace* space)
    : surface_(surface),
      start_vertex_(surface.node_vertex(surface.NodeOf(from))),
      vertex_count_(static_cast<int>(surface.mesh().n_vertices())),
      limit_(limit),
      space_(space == nullptr ? own_ : *space) {
  if (space_.vertices.size() < surface.mesh().n_vertices()) {
    space_.vertices.resize(surface.mesh().n_vertices());
  }
  if (space_.edges.size() < surface.mesh().n_edges()) {
    space_.edges.resize(surface.mesh().n_edges());
  }
  for (const HalfedgeHandle halfedge : surface.Fan(from)) LeaveVertex(halfedge, -1, 0);
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    const auto [length, place] = queue_.back();
    queue_.pop_back();
    if (length > At(place).length) continue;
    if (place >= vertex_count_) {
      LeaveEdge(EdgeHandle(place - vertex_count_), place, length);
      continue;
    }
    for (const HalfedgeHandle halfedge : surface_.mesh().voh_range(VertexHandle(place))) {
      LeaveVertex(halfedge, place, length);
    }
  }
}

ShortestPaths::~ShortestPaths() {
  for (const int place : touched_) At(place) = {};
}

SearchSpace::Reached& ShortestPaths::At(int place) {
  return place < vertex_count_ ? space_.vertices[static_cast<std::size_t>(place)]
                               : space_.edges[static_cast<std::size_t>(place - vertex_count_)];
}

const SearchSpace::Reached& ShortestPaths::At(int place) const {
  return place < vertex_count_ ? space_.vertices[static_cast<std::size_t>(place)]
                               : space_.edges[static_cast<std::size_t>(place - vertex_count_)];
}

Eigen::Vector3d ShortestPaths::PointOf(int place) const {
  if (place < vertex_count_) return surface_.Point(place);
  const HalfedgeHandle halfedge =
      surface_.mesh().halfedge_handle(EdgeHandle(place - vertex_count_), 0);
  return (surface_.mesh().point(surface_.mesh().from_vertex_handle(halfedge)) +
          surface_.mesh().point(surface_.mesh().to_vertex_handle(halfedge))) /
         2;
}

void ShortestPaths::Enter(int place, int before, double length) {
  if (length > limit_) return;
  SearchSpace::Reached& reached = At(place);
  if (length >= reached.length) return;
  if (reached.length == std::numeric_limits<double>::infinity()) touched_.push_back(place);
  reached = {length, before};
  queue_.emplace_back(length, place);
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

// `leaving`: a half-edge from the vertex that bounds the face it is entered from, or the way
// itself.
void ShortestPaths::EnterVertex(VertexHandle vertex, HalfedgeHandle leaving, int before,
                                const Eigen::Vector3d& from, double length) {
  const double sum = length + (surface_.mesh().point(vertex) - from).norm();
  if (surface_.IsFree(vertex)) return Enter(vertex.idx(), before, sum);
  if (surface_.Node(vertex) < 0 || vertex.idx() == start_vertex_ || sum > limit_) return;
  const Corner corner = surface_.CornerAt(leaving);
  const auto [entry, is_new] = lengths_.try_emplace(corner, sum);
  if (!is_new && sum >= entry->second) return;
  entry->second = sum;
  before_goal_[corner] = before;
}

void ShortestPaths::EnterEdge(HalfedgeHandle halfedge, int before, const Eigen::Vector3d& from,
                              double length) {
  if (surface_.Directed(halfedge) >= 0) return;
  const int place = vertex_count_ + surface_.mesh().edge_handle(halfedge).idx();
  Enter(place, before, length + (PointOf(place) - from).norm());
}

// Goes on along a half-edge that leaves the vertex, and across the face on its left.
void ShortestPaths::LeaveVertex(HalfedgeHandle leaving, int before, double length) {
  const mesh::HalfedgeMesh& mesh = surface_.mesh();
  const Eigen::Vector3d from = mesh.point(mesh.from_vertex_handle(leaving));
  EnterEdge(mesh.next_halfedge_handle(leaving), before, from, length);
  if (surface_.Directed(leaving) >= 0) return;
  EnterVertex(mesh.to_vertex_handle(leaving), mesh.opposite_halfedge_handle(leaving), before, from,
              length);
}

void ShortestPaths::LeaveEdge(EdgeHandle edge, int place, double length) {
  const mesh::HalfedgeMesh& mesh = surface_.mesh();
  const Eigen::Vector3d from = PointOf(place);
  for (const unsigned side : {0U, 1U}) {
    const HalfedgeHandle halfedge = mesh.halfedge_handle(edge, side);
    const HalfedgeHandle next = mesh.next_halfedge_handle(halfedge);
    const HalfedgeHandle last = mesh.prev_halfedge_handle(halfedge);
    EnterEdge(next, place, from, length);
    EnterEdge(last, place, from, length);
    EnterVertex(mesh.to_vertex_handle(next), last, place, from, length);
  }
}

void ShortestPaths::PullTaut(Trace& trace) const {
  const mesh::HalfedgeMesh& mesh = surface_.mesh();
  std::vector<Eigen::Vector3d> points;
  const auto ends = [&](const TracePoint& place) {
    const HalfedgeHandle halfedge = mesh.halfedge_handle(EdgeHandle(place.edge), 0);
    return std::pair<Eigen::Vector3d, Eigen::Vector3d>(
        mesh.point(mesh.from_vertex_handle(halfedge)), mesh.point(mesh.to_vertex_handle(halfedge)));
  };
  for (const TracePoint& place : trace) {
    points.push_back(PointOf(place.vertex >= 0 ? place.vertex : vertex_count_ + place.edge));
  }
  for (int sweep = 0; sweep < kMaximumSweeps; ++sweep) {
    double moved = 0;
    for (std::size_t i = 1; i + 1 < trace.size(); ++i) {
      if (trace[i].vertex >= 0) continue;
      const auto [a, b] = ends(trace[i]);
      const double share =
          std::clamp(Crossing(a, b, points[i - 1], points[i + 1]), kMargin, 1 - kMargin);
      moved = std::max(moved, std::abs(share - trace[i].share));
      trace[i].share = share;
      points[i] = (1 - share) * a + share * b;
    }
    if (moved < kStill) return;
  }
}

Trace ShortestPaths::PathTo(Corner to) const {
  Trace trace = {{.vertex = surface_.node_vertex(surface_.NodeOf(to))}};
  for (int place = before_goal_.at(to); place >= 0; place = At(place).before) {
    if (place < vertex_count_) trace.push_back({.vertex = place});
    if (place >= vertex_count_) trace.push_back({.edge = place - vertex_count_, .share = 0.5});
  }
  trace.push_back({.vertex = start_vertex_});
  std::reverse(trace.begin(), trace.end());
  PullTaut(trace);
  return trace;
}

}  // namespace mortise::interpolator
