// The surface of a design, as descriptors see it.
#pragma once

#include <set>
#include <string>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

// Returns the triangles of all parts, one part after the other in the design's order, metres. Where
// parts touch, both have triangles. Designs of one revision and structure have the same triangles;
// only the vertices move.
mesh::SurfaceMesh DesignSurface(const parametric::EvaluatedDesign& design);

// The same of some parts, by name. NOT_FOUND naming a part that the design does not have.
absl::StatusOr<mesh::SurfaceMesh> DesignSurface(const parametric::EvaluatedDesign& design,
                                                const std::set<std::string>& parts);

}  // namespace mortise::retrieval
