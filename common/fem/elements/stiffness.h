// Integrates stiffness and mass of an assembly: K = Σ ∫ Bᵀ D B dV and M = Σ ∫ ρ Nᵀ N dV over its
// elements.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/elements/material.h"
#include "common/fem/elements/matrix_assembly.h"
#include "common/fem/linear/block_matrix.h"

namespace mortise::simulator {

// Integrates every element; exact for straight-sided ones. INVALID_ARGUMENT if the mesh is no mesh
// ("tetrahedra", "nodes", "part"), or naming "tetrahedra[e]", its part and place if an element is
// inverted or has no volume. `materials`: one for each part, already checked. The result is the
// same to the bit for a team of any size.
absl::StatusOr<BlockMatrix> AssembleStiffness(const mesh::TetrahedralMesh& mesh,
                                              const std::vector<Material>& materials,
                                              const NodeFrames& frames, ThreadTeam& team);

// Returns the same along x, y, z at every node, by the calling thread.
absl::StatusOr<BlockMatrix> AssembleStiffness(const mesh::TetrahedralMesh& mesh,
                                              const std::vector<Material>& materials);

// Returns the consistent mass, kg, by a rule of degree 5 (exact for straight-sided elements), on
// the pattern of a stiffness of the same mesh. Fails as AssembleStiffness does.
absl::StatusOr<BlockMatrix> AssembleMass(const mesh::TetrahedralMesh& mesh,
                                         const std::vector<Material>& materials,
                                         const NodeFrames& frames,
                                         std::shared_ptr<const BlockPattern> pattern,
                                         ThreadTeam& team);

}  // namespace mortise::simulator
