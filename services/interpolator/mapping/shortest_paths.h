// Finds short paths across a patch of a layout that cross no other path. Private to this folder.
//
// A path runs from a corner of the patch to another one through free vertices and across the edges
// between them: Dijkstra's algorithm on vertices and the middles of edges. As edges between two
// vertices that are taken can be crossed, no part of a patch is closed off. It is then pulled taut:
// the places where it crosses edges slide along these until it is as short as in the triangles that
// it goes through it can be. This is chosen over exact geodesics of the whole surface (such as
// CGAL's), which run along other paths and across them.
#pragma once

#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "services/interpolator/mapping/layout_surface.h"

namespace mortise::interpolator {

class ShortestPaths {
 public:
  // Searches from a corner to all others of its patch no further than `limit`, m, away. The surface
  // must stay as it is while this is used.
  ShortestPaths(const LayoutSurface& surface, Corner from, double limit);

  // Returns the lengths of the paths found, before these are pulled taut.
  const std::map<Corner, double>& lengths() const { return lengths_; }

  // Returns the path to a corner that was found, pulled taut.
  Trace PathTo(Corner to) const;

 private:
  // Vertices of the mesh come first, behind them its edges.
  struct Reached {
    double length = 0;
    int before = -1;  // −1 for the start
  };

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
  std::unordered_map<int, Reached> reached_;
  std::vector<std::pair<double, int>> queue_;  // a heap, nearest first
  std::map<Corner, double> lengths_;
  std::map<Corner, int> before_goal_;
};

}  // namespace mortise::interpolator
