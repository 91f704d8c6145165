// Gmsh's MSH files, versions 2.2 and 4.1, text and binary (little-endian).
#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "common/mesh/files/grouped_mesh.h"

namespace mortise::mesh {

// Tetrahedra of 4 or 10 nodes make the mesh. Physical groups become groups: of volumes, elements;
// of surfaces, faces; of curves and points, nodes. One without a name is called by its number.
// Surfaces' triangles must be sides of tetrahedra. What is in no group of surfaces, curves or
// points is left out.
//
// INVALID_ARGUMENT naming "mesh_file", with the line of text or the byte of a binary file: other
// versions, elements of other kinds (named), partitioned meshes, and whatever is broken.
absl::StatusOr<GroupedMesh> ReadGmsh(std::string_view bytes);

}  // namespace mortise::mesh
