// Makes the conforming surface of an assembly of touching parts.
//
// A general fuse splits all parts' faces along each other, so that where two parts touch there is
// one face that belongs to both. Each face is triangulated once, with the points on shared edges in
// common, so the triangles form one complex without T-junctions in which every part is a closed
// region: what a tetrahedral mesher needs to glue the parts together.
//
// Drawings are not exact. Faces that look at each other across no more than kDrawingTolerance, and
// parts that reach into each other by no more, are taken as touching: where that occurs the fuse is
// made again with the smallest tolerance that joins them, up to this one; vertices and edges nearer
// than it become one.
//
// Points on curved faces lie a little outside them, so that parts keep their volumes and sections
// (facet_balance.h); where they, and the middles of sides, are on the faces is told besides
// (mesh::ExactPlaces).
#pragma once

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/mesh/shapes/part_shape.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::cad {

inline constexpr double kDrawingTolerance = 1e-4;  // m

// The distance by which triangles may miss a curved face, as a share of its part's diagonal. They
// miss it by less where it passes another part's face at a small distance, which they must not
// cross.
inline constexpr double kChordTolerance = 2e-3;

// The reason of a failure where Gmsh is needed and not installed.
inline constexpr char kNoGmsh[] = "NO_GMSH";

struct FuseOptions {
  // The wanted size of the elements between the triangles, m; 0 for mesh::DefaultElementSize. With
  // it, parts with curved faces get triangles that are about as wide as they are high, and as long
  // as elements beside them should be. Gmsh makes them (gmsh_triangles.h), or the kernel where Gmsh
  // fails, or there would be more than 100,000. Without it the kernel makes them; its triangles
  // follow round faces with needles.
  std::optional<double> element_size;
};

// Makes the surface of `parts` together. Every AssemblyFace names the faces of the parts it is a
// piece of. Triangles of a face between two parts point from the part of lower index into the other
// one; those on the outside point outwards (front_part -1).
//
// INVALID_ARGUMENT naming "parts" for parts that penetrate each other, with the names of the first
// four pairs and how far, or "parts[i]" for a part that touches itself. FAILED_PRECONDITION,
// NOT_BONDED, for two parts nearer to each other than the tolerance that the kernel cannot join;
// NO_GMSH where Gmsh is needed and not installed. INTERNAL if the kernel fails.
absl::StatusOr<mesh::AssemblySurface> FuseAssembly(const std::vector<Solid>& parts,
                                                   const FuseOptions& options = {});

// Does the same for prisms. INVALID_ARGUMENT naming "parts[i]" too where a shape is degenerate.
absl::StatusOr<mesh::AssemblySurface> FuseAssembly(const std::vector<mesh::PartShape>& parts);

}  // namespace mortise::cad
