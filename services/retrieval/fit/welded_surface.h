// A surface as people have it, with what is known of how its triangles hang together.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

// The triangles with an area. Vertices at one place are one.
struct WeldedSurface {
  Eigen::Matrix3Xd vertices;    // 3 × V
  Eigen::Matrix3Xi triangles;   // 3 × T, turned to face out of what they bound
  Eigen::Matrix3Xd areas;       // 3 × T: normals as long as the areas
  Eigen::Matrix3Xi neighbours;  // 3 × T: the triangle over the edge from corner k to k + 1, or -1
  std::vector<bool> sided;      // T: whether it is known which of its sides is outside
  double diagonal = 0;          // of the box around it
};

// Welds a surface, and turns its triangles: in each piece that hangs together over edges of two
// triangles they are turned alike, and outwards if the piece bounds a volume, holes or not. Pieces
// that are flat or single triangles stay as they are, and are not `sided`. INVALID_ARGUMENT,
// "query", without triangles that have an area, or with indices of no vertex. Triangles with
// coordinates that are not finite are left out. O(T log T).
absl::StatusOr<WeldedSurface> Weld(const mesh::SurfaceMesh& surface);

// Returns the standard deviation of noise that the vertices have along the normal, estimated by how
// far they lie from the middle of those around them, or, where that is much less, by how far the
// neighbours of triangles are out of their planes, medians both; m. Next to nothing on smooth
// surfaces, whatever their edges, and however few and large their triangles are: a mesh most of
// whose triangles lie in the plane of a neighbour has no noise. 0 for what has few vertices within.
double EstimateNoise(const WeldedSurface& surface);

}  // namespace mortise::retrieval
