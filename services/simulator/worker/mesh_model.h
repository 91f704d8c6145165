// Makes the model that is analysed of an uploaded mesh and its case: groups become parts, faces and
// nodes.
#pragma once

#include "absl/status/statusor.h"
#include "services/simulator/analysis/mesh_analysis.h"

namespace mortise::mesh {
struct GroupedMesh;
}
namespace mortise::v1 {
class MeshCase;
}

namespace mortise::simulator {

// `mesh_case` has passed CheckMeshCase with "case" and names no material of the catalog. There is a
// part for each entry of its materials. INVALID_ARGUMENT naming "mesh_file" for elements that are
// inverted or flat, how many and the first one's number; "case.…" for groups that the mesh lacks
// (with the most similar name), that are empty or of the wrong kind, faces within the body under
// loads, and elements that have no material, or two. RESOURCE_EXHAUSTED naming the list in which
// conditions come to name a multiple of what the mesh has.
absl::StatusOr<MeshModel> MakeMeshModel(const mesh::GroupedMesh& mesh,
                                        const v1::MeshCase& mesh_case);

}  // namespace mortise::simulator
