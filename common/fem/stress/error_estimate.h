// Estimates how far a finite element solution is from the true one (Zienkiewicz and Zhu, Int. J.
// Numer. Methods Eng. 33, 1992, 1331-1382).
//
// The stress of elements, σₕ, jumps between them; the smoothed stress σ* does not and is one order
// more accurate. Their difference stands for the error: η² = ∫ (σ* − σₕ)ᵀ D⁻¹ (σ* − σₕ) dV.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fem/elements/material.h"
#include "common/fem/linear/thread_team.h"
#include "common/fem/stress/surface_traction.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

struct ErrorEstimate {
  Eigen::VectorXd element_error;  // elements, √J: η of each, large where refinement pays
  double error = 0;               // √J: the root of the sum of their squares
  double energy_norm = 0;         // √J: √∫ σₕᵀ D⁻¹ σₕ dV of the solution
  double relative = 0;  // error over √(energy_norm² + error²): 0.05 is good engineering
};

// Estimates the error of a displacement (3 × nodes, m) under a temperature (nodes, K, or empty) and
// tractions, where they are known.
// Where stress is singular (re-entrant corners, the edges of clamps) the estimate stays finite and
// says where, but no refinement makes the stress there right.
ErrorEstimate EstimateError(const mesh::TetrahedralMesh& mesh,
                            const std::vector<Material>& materials,
                            const Eigen::Matrix3Xd& displacement,
                            const Eigen::VectorXd& temperature, ThreadTeam& team,
                            const SurfaceTraction& traction = {});

// Returns the size (m) that elements should have for a relative error of `wanted`, one for each
// element: those that give it with the fewest elements, if an element's error η falls with its size
// to the power p of its degree. All elements then have errors in the proportion η^(3 / (2p + 3)) of
// today's (Coorevits, Ladevèze and Pelle 1995). Never less than a fifth nor more than twice the
// present size.
Eigen::VectorXd ElementSizes(const mesh::TetrahedralMesh& mesh, const ErrorEstimate& estimate,
                             double wanted);

}  // namespace mortise::simulator
