// Computes how solids float upright in still water; z points upwards.
#pragma once

#include <Eigen/Core>
#include <span>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// A body at rest that displaces its own mass of water.
struct Floating {
  double displaced_volume = 0;  // m³
  double draught = 0;           // m, from the lowest point up to the water
  double freeboard = 0;         // m, from the water up to the highest point
  // m, from the centre of mass up to the metacentre, GM = KB + I / V − KG, with the least second
  // moment I of the area cut by the water about its own centre; negative where it would capsize.
  double metacentric_height = 0;
};

// Returns the equilibrium of solids of `mass` (kg, > 0) in water of `water_density` (kg/m³, > 0),
// upright as they are drawn: heel and trim are not looked at. Surfaces are closed and outward, and
// solids do not overlap. Only the solids displace water: it enters whatever is hollow. Integrals
// over the surface below the water are exact for polyhedra; the draught is found to 1e-12 of the
// height.
//
// FAILED_PRECONDITION, SINKS, if the whole of it displaces less than its mass. O(T) for each of
// some dozen trials.
absl::StatusOr<Floating> FloatUpright(std::span<const SurfaceMesh> solids, double mass,
                                      const Eigen::Vector3d& center_of_mass, double water_density);

}  // namespace mortise::mesh
