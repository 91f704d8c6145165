// The stiffness matrix of an assembly: K = Σ ∫ Bᵀ D B dV over its elements.
#pragma once

#include "absl/status/statusor.h"
#include "services/simulator/analysis_case.h"
#include "services/simulator/block_matrix.h"

namespace mortise::simulator {

// Integrates every element; exact for straight-sided ones. INVALID_ARGUMENT naming "tetrahedra[e]",
// its part and place if an element is inverted or has no volume. `materials`: one for each part,
// already checked.
absl::StatusOr<BlockMatrix> AssembleStiffness(const mesh::TetrahedralMesh& mesh,
                                              const std::vector<Material>& materials);

}  // namespace mortise::simulator
