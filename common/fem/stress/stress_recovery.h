// Computes stresses from displacements: at integration points, and smoothed to the nodes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fem/elements/analysis_case.h"
#include "common/fem/linear/thread_team.h"
#include "common/fem/stress/part_surface.h"
#include "common/fem/stress/patch_recovery.h"
#include "common/fem/stress/surface_stress.h"

namespace mortise::simulator {

// Returns the stresses σ = D (ε − ε_T) where they are most accurate: 6 × (points · elements), Pa,
// xx yy zz xy yz xz, those of an element in a row. Linear elements have one point (the centroid),
// quadratic ones four, those of TetrahedronRule. `temperature`: nodes, K, or empty.
Stresses StressAtPoints(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                        const Eigen::Matrix3Xd& displacement, const Eigen::VectorXd& temperature,
                        ThreadTeam& team);

struct NodalStress {
  Stresses stress;                    // 6 × nodes, Pa: xx yy zz xy yz xz
  Eigen::VectorXd von_mises;          // nodes, Pa
  Eigen::VectorXd maximum_principal;  // nodes, Pa
  Eigen::VectorXd part_maximum;       // parts, Pa: largest von Mises stress of each
};

// Returns the stresses of a body at the nodes as each part sees them, 6 × slots: on its surface
// from the strains along it and the tractions (SurfaceStress) where these are known, all else by
// RecoverByPatches.
Stresses RecoverAtSlots(const DeformedBody& body, const PartNodes& nodes,
                        const PartSurface& surface, ThreadTeam& team);

// Returns the stresses of each node. Where parts meet, `stress`, `von_mises` and
// `maximum_principal` are those of the part under the larger von Mises stress.
NodalStress RecoverStress(const DeformedBody& body, const PartNodes& nodes,
                          const PartSurface& surface, ThreadTeam& team);

}  // namespace mortise::simulator
