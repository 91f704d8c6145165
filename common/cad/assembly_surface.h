// The conforming surface of an assembly of touching parts.
//
// A general fuse splits all parts' faces along each other, so that where two parts touch there is
// one face that belongs to both. Each face is triangulated once, with the points on shared edges in
// common, so the triangles form one complex without T-junctions in which every part is a closed
// region: what a tetrahedral mesher needs to glue the parts together.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/part_shape.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::cad {

// The surface of `parts` together. Every AssemblyFace names the faces of the parts it is a piece
// of. Triangles of a face between two parts point from the part of lower index into the other one;
// those on the outside point outwards (front_part -1).
//
// INVALID_ARGUMENT naming "parts[i]" where a shape is degenerate, or parts penetrate each other.
absl::StatusOr<mesh::AssemblySurface> FuseAssembly(const std::vector<mesh::PartShape>& parts);

}  // namespace mortise::cad
