// Computes nodal forces that do the same work as the loads of a case (consistent loads).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/elements/analysis_case.h"

namespace mortise::simulator {

// Returns the forces, 3 × nodes, N: ∫ Nᵀ t dA over loaded faces, ∫ Nᵀ b dV of gravity, rotation and
// body force, ∫ Bᵀ D ε_T dV of the temperature, and the point forces. The case has been checked.
// INVALID_ARGUMENT naming "point_forces[i].position" if that lies outside the body, and
// "tractions[i].traction" or "body_force" if they yield a number that is not finite.
absl::StatusOr<Eigen::Matrix3Xd> AssembleLoads(const mesh::TetrahedralMesh& mesh,
                                               const std::vector<Material>& materials,
                                               const LoadCase& loads);

}  // namespace mortise::simulator
