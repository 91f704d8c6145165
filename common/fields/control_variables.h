// The control variables of a design's file of shape and fields, as maps from mesh to mesh need them
// (thesis §6.6.2).
#pragma once

#include "absl/status/statusor.h"
#include "common/fields/design_fields.h"
#include "common/mesh/control_variables.h"

namespace mortise::fields {

// Returns how long pieces of edges of a shape with these nodes are at most, m: a quarter of the
// diagonal of their box.
double ControlSpacing(const Eigen::Matrix3Xd& nodes);

// Gives the design these points and ways, without what has a name longer than kMaximumNameLength,
// and none at all where they are more than a design may have. A point's node is its `vertex`.
void SetControlVariables(const mesh::ControlVariables& variables, DesignFields& design);

// Returns the control points, ways and paths of a design that passes Check. `vertex` of a point is
// its node, where it has one, and it lies where that does.
//
// A path is cut where control points are at its nodes. Where it begins and ends without one there
// is a point of its own, "ID from" and "ID to". Its pieces are halved as those of edges of models
// (mesh/edge_sampling.h) until none is longer than ControlSpacing.
//
// A design that has neither points, ways nor paths has those of its outer surface, where triangles
// of different regions, or of different parts, meet (mesh/face_edges.h).
//
// RESOURCE_EXHAUSTED where there would be more than mesh::kMaximumSamples of points that the file
// does not have. O(size log size).
absl::StatusOr<mesh::ControlVariables> ControlVariablesOf(const DesignFields& design);

}  // namespace mortise::fields
