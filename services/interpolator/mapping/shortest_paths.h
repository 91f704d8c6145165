// Finds short paths across a patch of a layout that cross no other path. Private to this folder.
//
// A path runs from a corner of the patch to another one through free vertices and across the edges
// between them: Dijkstra's algorithm on vertices and the middles of edges. As edges between two
// vertices that are taken can be crossed, no part of a patch is closed off. It is then pulled taut:
// the places where it crosses edges slide along these until it is as short as in the triangles that
// it goes through it can be. This is chosen over exact geodesics of the whole surface (such as
// CGAL's), which run along other paths and across them.
#pragma once

#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "services/interpolator/mapping/layout_surface.h"

namespace mortise::interpolator {

// What searches of one surface after another use again, so that each takes no longer than what it
// reaches.
struct SearchSpace {
  struct Reached {
    double length = std::numeric_limits<double>::infinity();
    int before = -1;  // −1 for the start
  };
  // Vertices of the mesh, and its edges.
  std::vector<Reached> vertices, edges;
};

class ShortestPaths {
 public:
  // Searches from a corner to all others of its patch no further than `limit`, m, away. The surface
  // must stay as it is while this is used, and `space`, if there is one, is used by nothing else.
  ShortestPaths(const LayoutSurface& surface, Corner from, double limit,
                SearchSpace* space = nullptr);
  ~ShortestPaths();
  ShortestPaths(const ShortestPaths&) = delete;
  ShortestPaths& operator=(const ShortestPaths&) = delete;

  // Returns the lengths of the paths found, before these are pulled taut.
  const std::map<Corner, double>& lengths() const { return lengths_; }

  // Returns the path to a corner that was found, pulled taut.
  Trace PathTo(Corner to) const;

 private:
  // Places are vertices of the mesh, and behind them its edges.
  SearchSpace::Reached& At(int place);
  const SearchSpace::Reached& At(int place) const;
  Eigen::Vector3d PointOf(int place) const;
  void Enter(int place, int before, double length);
  void EnterVertex(OpenMesh::VertexHandle vertex, OpenMesh::HalfedgeHandle leaving, int before,
                   const Eigen::Vector3d& from, double length);
  void EnterEdge(OpenMesh::HalfedgeHandle halfedge, int before, const Eigen::Vector3d& from,
                 double length);
  void LeaveVertex(OpenMesh::HalfedgeHandle leaving, int before, double length);
  void LeaveEdge(OpenMesh::EdgeHandle edge, int place, double length);
  void PullTaut(Trace& trace) const;

  const LayoutSurface& surface_;
  int start_vertex_;
  int vertex_count_;
  double limit_;
  SearchSpace own_;  // where none was given
  SearchSpace& space_;
  std::vector<int> touched_;                   // places
  std::vector<std::pair<double, int>> queue_;  // a heap, nearest first
  std::map<Corner, double> lengths_;
  std::map<Corner, int> before_goal_;
};

}  // namespace mortise::interpolator
