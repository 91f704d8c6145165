// How the stress recovered at a node changes with the displacements and places of the nodes around:
// the exact derivatives of what RecoverByPatches gives, in closed form.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"
#include "services/simulator/material.h"
#include "services/simulator/patch_recovery.h"

namespace mortise::simulator {

// Both 3 × nodes.
struct StressDerivative {
  double value = 0;  // Pa
  Eigen::Matrix3Xd by_displacement;
  Eigen::Matrix3Xd by_position;
};

// Of direction · σ at a slot, σ as xx yy zz xy yz xz. `materials`: one for each part; `at_points`:
// from StressAtPoints, of a body that is not warm. O(nodes + elements).
StressDerivative NodalStressDerivative(const mesh::TetrahedralMesh& mesh,
                                       const std::vector<Material>& materials,
                                       const Eigen::Matrix3Xd& displacement,
                                       const Stresses& at_points, const PartNodes& nodes, int slot,
                                       const Vector6d& direction);

// The gradients of VonMises and MaximumPrincipal by the stress: zero where there is none, and one
// of several where principal stresses are equal.
Vector6d VonMisesGradient(const Vector6d& stress);
Vector6d MaximumPrincipalGradient(const Vector6d& stress);

}  // namespace mortise::simulator
