// Takes along the triangles between parts when the outside of a design is mapped. Private to this
// folder; model_surface_map.h says how.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "services/interpolator/mapping/outer_surface.h"

namespace mortise::interpolator {

struct PartTriangles {
  mesh::SurfaceMesh surface;               // those between parts, all vertices
  std::vector<std::pair<int, int>> parts;  // of each triangle: the parts on its sides, ascending
};

// Fills in the positions and places of the target's vertices that are not known, and returns how
// many these are. `all`: all triangles of the source, in which places are searched that are on none
// between the same parts. INTERNAL if the equations cannot be solved.
absl::StatusOr<int> FollowBetweenParts(const PartTriangles& source, const PartTriangles& target,
                                       const mesh::SurfaceMesh& all,
                                       const std::vector<bool>& is_known,
                                       Eigen::Matrix3Xd& positions, std::vector<NodePlace>& places);

}  // namespace mortise::interpolator
