// Makes closed surfaces of triangles that nearly are: what other programs export, STL above all.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

struct RepairOptions {
  // Of the diagonal of the surface's box, 1e-9 to 1e-2: what is nearer to each other is in one
  // place.
  double tolerance = 1e-6;
  // Of the area of the connected piece with the hole, 0 to 1: holes that take more to fill are
  // refused. Holes of one missing triangle are filled whatever their size, as there is one way
  // only.
  double largest_hole = 0.01;
};

// What was put right.
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

// In words with counts and millimetres, for people; empty if nothing was done.
std::vector<std::string> Describe(const SurfaceRepairs& repairs);

struct RepairedSurface {
  SurfaceMesh surface;
  SurfaceRepairs repairs;
};

// Returns the closed, outward surface that `surface` was meant to be. One that IsWatertight stays
// as it is, to the bit. Of others vertices within the tolerance become one, and those that no
// triangle uses are dropped, triangles without area, and all but one of those drawn twice, are
// dropped; both of those that
//     face each other as a wall within a solid,
//   triangles are divided at vertices of the surface's borders that lie on their edges,
//   triangles are turned as their neighbours, and each closed piece outwards, or inwards within
//     another,
//   small holes are filled (Liepa 2003, as CGAL has it).
// Whether the surface crosses itself is not looked at.
//
// INVALID_ARGUMENT, "surface", with the places of the first few: what CheckNumbers finds, edges
// where more than two triangles meet, surfaces with one side only, holes that are too large, single
// triangles, pieces that meet in a single vertex, what encloses nothing, and triangles that would
// be divided into more than four each. INVALID_ARGUMENT naming the option out of range. About O(T
// log T); O(T^(4/3)) for long triangles that have nothing to do with each other, and O(n³) for
// holes of up to 100 edges that are far from flat.
absl::StatusOr<RepairedSurface> RepairSurface(const SurfaceMesh& surface,
                                              const RepairOptions& options = {});

}  // namespace mortise::mesh
