// Holds loose triangles as files have them, and puts right what can be put right before it is known
// which side of them is the outside; for surface_repair.cpp.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

class CutSurface;

class TriangleSoup {
 public:
  // The indices must be of vertices, and the coordinates finite. Vertices nearer to each other than
  // `tolerance`, m, > 0 and at least 1e-12 of the extent, become one.
  TriangleSoup(const SurfaceMesh& surface, double tolerance);

  // Returns how many vertices that triangles use became others.
  int merged_vertices() const { return merged_vertices_; }

  // Drops triangles that have no area, and returns how many.
  int DropDegenerate();

  // Drops triangles drawn twice, whichever way, and returns how many. One of them stays. Of those
  // that are drawn both ways none stays if they make an edge of more than two triangles, as walls
  // between two solids do.
  int DropRepeated();

  // Divides triangles at vertices that lie within the tolerance of an edge with one triangle only,
  // and are at such an edge themselves: the two sides of a T-junction. Returns how many triangles
  // it divided. INVALID_ARGUMENT, "surface", if there are more such vertices than a few to each
  // triangle.
  absl::StatusOr<int> SplitAtVertices();

  // Returns what is left, with the vertices that it uses.
  SurfaceMesh Surface() const;

 private:
  struct Border;

  static std::vector<Border> BordersOf(const CutSurface& surface);
  absl::Status FindVerticesOn(std::vector<Border>& borders) const;

  double tolerance_;
  std::size_t most_triangles_;
  int merged_vertices_ = 0;
  Eigen::Matrix3Xd vertices_;
  std::vector<Eigen::Vector3i> triangles_;
};

// Returns triangles as an index array.
Eigen::Matrix3Xi ToMatrix(const std::vector<Eigen::Vector3i>& triangles);

}  // namespace mortise::mesh
