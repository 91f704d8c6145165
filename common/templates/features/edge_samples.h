// Finds the control variables of a solid made of features: its vertices and points along its edges,
// by names that are made of what the faces beside them come from (thesis §6.6.2).
//
// Face, edge and vertex have a first name: a face all names that lead to it, an edge the names of
// its two faces, a vertex those of the faces around it. The name of an edge is its first name with
// those of its vertices, sorted; of a vertex, its first name with those of its edges. So names
// agree at two parameters only where nothing around the edge or vertex has merged, split or gone.
// What has the same name as another is named again with faces of one name told apart by what they
// lie beside (mesh/distinct_names.h); what then still has the same name as another has none. Nor
// have seams of closed faces, their vertices and edges without length.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/mesh/control_variables.h"
#include "common/templates/features/feature_model.h"

namespace mortise::cad {

// Edges are halved until no piece is longer than `spacing`, m; closed edges into four at least
// (mesh/edge_sampling.h). A sample's name is that of the edge and where it is, as a fraction of the
// edge's length from the vertex of lower name: "plate.end & plate.outline.right between … at 3/8".
// Closed edges are counted from where the kernel begins them, with the face of lower name on the
// left. `face_names` has all names of each face of the solid.
// INVALID_ARGUMENT naming "spacing" unless it is positive and finite; RESOURCE_EXHAUSTED beyond
// 100,000 samples; INTERNAL if the kernel fails.
absl::StatusOr<mesh::ControlVariables> FindControlVariables(
    const Solid& solid, const std::vector<std::vector<std::string>>& face_names, double spacing);

absl::StatusOr<mesh::ControlVariables> FindControlVariables(const RegeneratedModel& model,
                                                            double spacing);

}  // namespace mortise::cad
