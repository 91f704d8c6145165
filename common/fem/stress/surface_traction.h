// Finds the forces on the outside of a body, where they are known: what the stress there has to
// balance.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fem/elements/analysis_case.h"
#include "common/fem/stress/part_surface.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

struct SurfaceTraction {
  // The traction at the nodes of each face of a PartSurface in a row, 3 × (nodes of a face ·
  // faces), Pa; zero where nothing acts. It is not a number where it is not known: of faces that
  // are held or between parts, and of those with forces on their nodes.
  Eigen::Matrix3Xd at_nodes;
  // faces: whether it is held along its normal only. The body goes on beyond as its mirror image.
  std::vector<bool> mirrors;
};

// Returns the traction. `supports` and `loads` have been checked.
SurfaceTraction TractionOn(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                           const std::vector<Support>& supports, const LoadCase& loads);

// Says by how much something changes with the traction at a node of a face.
struct ByTraction {
  FaceNode at;
  Eigen::Vector3d derivative;
};

// Returns how the traction then changes as nodes move and loads stay the same: 3 × nodes, of forces
// and pressures.
Eigen::Matrix3Xd TractionDerivative(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                                    const LoadCase& loads, const std::vector<ByTraction>& changes);

// Adds how something changes, as nodes move, that changes by this with the normal at a node of a
// face: the normal n turns by −Σ ∇Nₖ (n · δxₖ).
void AddNormalDerivative(const mesh::TetrahedralMesh& mesh, const PartSurface& surface,
                         const FaceNode& at, const Eigen::Vector3d& by_normal,
                         Eigen::Matrix3Xd& by_position);

}  // namespace mortise::simulator
