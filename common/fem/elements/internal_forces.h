// Computes the forces at the nodes that a displacement of the elements stands for, to more digits
// than K u.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fem/elements/material.h"
#include "common/fem/linear/thread_team.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// Returns ∫ Bᵀ D ε(u) dV, 3 × nodes, N, in space. In a thin sheet that bends, stiffnesses of 1
// cancel down to the (thickness / length)⁴ that resists, and K u, whose sums are rounded before
// they cancel, is mostly rounding. Here strains come from differences within each element, in which
// what moves without deforming cancels first. The mesh has been checked; the result is the same to
// the bit on any number of threads.
Eigen::Matrix3Xd InternalForces(const mesh::TetrahedralMesh& mesh,
                                const std::vector<Material>& materials,
                                const Eigen::Matrix3Xd& displacement, ThreadTeam& team);

}  // namespace mortise::simulator
