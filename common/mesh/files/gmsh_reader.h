// Reads Gmsh's MSH files, versions 2.2 and 4.1, text and binary (little-endian).
#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "common/mesh/files/grouped_mesh.h"

namespace mortise::mesh {

// Tetrahedra of 4 or 10 nodes make the mesh. Physical groups of volumes become groups of elements,
// those of surfaces groups of faces, and those of curves and points groups of nodes. A group
// without a name is called by its number. Surfaces' triangles must be sides of tetrahedra.
// Triangles, lines and points in no group are left out.
//
// INVALID_ARGUMENT naming "mesh_file", with the line of text or the byte of a binary file, for
// other versions, elements of other kinds (named), partitioned meshes, and whatever is broken.
absl::StatusOr<GroupedMesh> ReadGmsh(std::string_view bytes);

}  // namespace mortise::mesh
