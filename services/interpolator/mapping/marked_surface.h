// Closed surfaces with points and paths on them whose names say what corresponds to what (thesis
// §6.6.2, control variables).
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::interpolator {

// A named vertex of a surface.
struct ControlPoint {
  std::string name;  // of one point of a surface only
  int vertex = -1;
};

// A way along edges of a surface from one control point to another: a piece of an edge of the CAD
// model. The pieces of one edge share its name.
struct ControlPath {
  std::string name;
  std::vector<int> vertices;  // from point to point; at least two, each joined to the next
};

// Closed and oriented, of one or several shells. Paths meet in control points only.
struct MarkedSurface {
  mesh::SurfaceMesh surface;
  std::vector<ControlPoint> points;
  std::vector<ControlPath> paths;
  // Of each triangle: which of the surface that the points were placed on it is a piece of. Empty
  // where nothing is known of one.
  std::vector<int> origin = {};
};

// Fails with INVALID_ARGUMENT below `field` ("source") unless the surface is closed and oriented,
// and points and paths are as said above.
absl::Status CheckMarkedSurface(const MarkedSurface& marked, const std::string& field);

// A connected piece of a surface.
struct Shell {
  std::vector<int> triangles;
  int genus = 0;  // the number of its handles
};

// What both surfaces have. Paths that lead through control points which only one surface has are
// joined, so that an edge which is divided more often in one corresponds too. What is ambiguous is
// left out: two paths of one edge between the same two points.
struct Correspondence {
  struct Point {
    std::string name;
    int source = -1, target = -1;  // vertices
  };
  struct Path {
    std::string name;
    std::vector<int> source, target;  // vertices, from the same point to the same point
  };
  std::vector<Point> points;  // by name
  std::vector<Path> paths;    // by name, then by the names of their ends
};

// Returns the connected pieces, in the order of their first triangles. The surface is closed.
std::vector<Shell> ShellsOf(const mesh::SurfaceMesh& surface);

// Returns what corresponds. The surfaces have been checked. FAILED_PRECONDITION, reason
// TOPOLOGY_DIFFERS, if the numbers of shells or of handles differ, or if points of one shell are on
// several of the other; TOO_FEW_POINTS if a shell has less than three points that both surfaces
// have: two leave open how it turns.
absl::StatusOr<Correspondence> FindCorrespondence(const MarkedSurface& source,
                                                  const MarkedSurface& target);

}  // namespace mortise::interpolator
