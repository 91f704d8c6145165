// Reads meshes in input files of Abaqus and CalculiX (.inp).
#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "common/mesh/files/grouped_mesh.h"

namespace mortise::mesh {

// Reads *NODE, *ELEMENT of type C3D4, C3D10 or C3D10M, *NSET and *ELSET (with GENERATE, and naming
// earlier sets), *SURFACE of element faces S1 to S4 or of nodes; ELSET= and NSET= of elements and
// nodes. Plane and surface triangles (CPS3, CPS6, SFM3D3, SFM3D6), as meshers write them, only mark
// faces: sets of them become groups of faces. Keywords, parameters and names of sets may be in
// upper or lower case; a group is called as its name is written first.
//
// A *PART (or its *INSTANCE, where that holds the mesh) and the assembly have each their own sets,
// and numbers of nodes. Members are the part's in the part, with INSTANCE= and as
// "instance.member". Where both have a set of one name, the assembly's keeps it and the part's is
// called "<part>.<name>" (in notes). Nodes of the assembly, points of reference, are left out.
//
// What belongs to an analysis (*MATERIAL, *STEP …) is not used; GroupedMesh::notes lists it.
// INVALID_ARGUMENT naming "mesh_file", with the line: *INCLUDE, elements of other kinds (named),
// whatever makes or moves nodes or elements (*NGEN, *SYSTEM, a second *PART or *INSTANCE, a moved
// one), elements of the assembly itself, lines over 64 kB, and whatever is broken.
absl::StatusOr<GroupedMesh> ReadAbaqus(std::string_view text);

}  // namespace mortise::mesh
