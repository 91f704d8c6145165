// Makes closed surfaces of triangles that nearly are: what other programs export, STL above all.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

struct RepairOptions {
  // Points nearer to each other than this share of the diagonal of the surface's box are in one
  // place, 1e-9 to 1e-2.
  double tolerance = 1e-6;
  // Holes that take more to fill than this share of the area of the connected piece with the hole
  // are refused, 0 to 1. Holes of one missing triangle are filled whatever their size, as there is
  // only one way.
  double largest_hole = 0.01;
};

// The repairs that were made.
struct SurfaceRepairs {
  double tolerance = 0;      // m, within which vertices were merged
  int merged_vertices = 0;   // that became others
  int without_area = 0;      // triangles that were dropped
  int drawn_twice = 0;       // triangles that were dropped
  int split_triangles = 0;   // at vertices that lay on their edges
  int turned_triangles = 0;  // the other side outwards
  int filled_holes = 0;
  double widest_hole = 0;  // m, across, of those filled
};

// Says the repairs in words with counts and millimetres, for people; empty if nothing was done.
std::vector<std::string> Describe(const SurfaceRepairs& repairs);

struct RepairedSurface {
  SurfaceMesh surface;
  SurfaceRepairs repairs;
};

// Returns the closed, outward surface that `surface` was meant to be. One that IsWatertight stays
// as it is, to the bit. Any other is repaired in these steps:
// - Vertices within the tolerance become one, and those that no triangle uses are dropped.
// - Triangles without area are dropped, and all but one of those drawn twice; both of those that
//   face each other as a wall within a solid.
// - Triangles are divided at vertices of the surface's borders that lie on their edges.
// - Triangles are turned as their neighbours, and each closed piece outwards, or inwards within
//   another.
// - Small holes are filled (Liepa 2003, as CGAL has it).
//
// Whether the surface crosses itself is not looked at.
//
// INVALID_ARGUMENT, "surface", with the places of the first few, for what CheckNumbers finds, edges
// where more than two triangles meet, surfaces with one side only, holes that are too large, single
// triangles, pieces that meet in a single vertex, surfaces that enclose nothing, and triangles that
// would be divided into more than four each. INVALID_ARGUMENT naming the option out of range. It
// takes about O(T log T); O(T^(4/3)) for long triangles that have nothing to do with each other,
// and O(n³) for holes of up to 100 edges that are far from flat.
absl::StatusOr<RepairedSurface> RepairSurface(const SurfaceMesh& surface,
                                              const RepairOptions& options = {});

}  // namespace mortise::mesh
