// Computes how the stress recovered at a node changes with the displacements and places of the
// nodes around: the derivatives of what RecoverAtSlots gives, in closed form but for how stresses
// on the surface are turned and weighed (stress_shares.h).
#pragma once

#include <Eigen/Core>

#include "common/fem/elements/material.h"
#include "common/fem/stress/part_surface.h"
#include "common/fem/stress/patch_recovery.h"
#include "common/fem/stress/surface_stress.h"

namespace mortise::simulator {

// Returns the derivative of direction · σ at a slot, σ as xx yy zz xy yz xz, as RecoverAtSlots
// gives it. `at_points` are from StressAtPoints, for a body that is not warm. O(nodes + elements).
StressDerivative NodalStressDerivative(const DeformedBody& body, const PartNodes& nodes,
                                       const PartSurface& surface, const Stresses& at_points,
                                       int slot, const Vector6d& direction);

// Returns the gradients of VonMises and MaximumPrincipal by the stress: zero where there is none,
// and one of several where principal stresses are equal.
Vector6d VonMisesGradient(const Vector6d& stress);
Vector6d MaximumPrincipalGradient(const Vector6d& stress);

}  // namespace mortise::simulator
