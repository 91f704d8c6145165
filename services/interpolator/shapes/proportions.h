// Metrics of geometry alone, computed of the interpolated shape itself rather than interpolated
// (thesis §6.7): exactly, up to the rounding of its numbers of 32 bits.
#pragma once

#include <Eigen/Core>

#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/canonical_mesh.h"

namespace mortise::interpolator {

struct Proportions {
  double surface_area = 0;  // m², of the outside of all parts together
  // Whether the outside is closed, so that it has a volume: else the following are 0.
  bool has_volume = false;
  double volume = 0;                                   // m³, all parts together
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // m, of the volume
};

// Returns the proportions of a shape in this mesh; its surface nodes are enough, as the volume of
// all tetrahedra is that within their outer faces, whatever happens inside.
Proportions ProportionsOf(const BlendedShape& shape, const CanonicalMesh& mesh);

}  // namespace mortise::interpolator
