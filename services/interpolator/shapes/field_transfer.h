// Carries fields from a design over to nodes and elements elsewhere. Private to this folder.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fields/design_fields.h"
#include "services/interpolator/mapping/outer_surface.h"
#include "services/interpolator/shapes/canonical_mesh.h"
#include "services/interpolator/shapes/corner_design.h"

namespace mortise::interpolator {

// Returns which fields of a design those of the mesh are. INVALID_ARGUMENT, "fields", naming the
// field and load case that the design lacks, or has in another unit, number of components or place.
absl::StatusOr<std::vector<const fields::Field*>> MatchFields(const fields::DesignFields& design,
                                                              const CanonicalMesh& mesh);

struct CarriedFields {
  std::vector<Eigen::MatrixXd> fields;  // in the mesh's order
  int outside = 0;                      // nodes and centres that lie outside of the design, and
  double furthest = 0;                  // m, how far at the most
};

// Returns the values of the matched fields in a shape of the mesh. `outer`: of the design.
// `nodes`: 3 × N, m, where the mesh's nodes are in the design's own space. `places`: of the
// first nodes, those on the surface, between nodes of the design; those that have none are located.
// Fails as NearestPlaces.
absl::StatusOr<CarriedFields> CarryFields(const std::vector<const fields::Field*>& matched,
                                          const fields::DesignFields& design,
                                          const OuterTriangles& outer, const CanonicalMesh& mesh,
                                          const Eigen::Matrix3Xd& nodes,
                                          const std::vector<NodePlace>& places);

}  // namespace mortise::interpolator
