// Nodal forces that do the same work as the loads of a case (consistent loads).
#pragma once

#include <Eigen/Core>

#include "services/simulator/analysis_case.h"

namespace mortise::simulator {

// 3 × nodes, N: ∫ Nᵀ t dA over loaded faces plus ∫ Nᵀ ρ g dV. The case has been checked.
Eigen::Matrix3Xd AssembleLoads(const mesh::TetrahedralMesh& mesh, const AnalysisCase& analysis);

}  // namespace mortise::simulator
