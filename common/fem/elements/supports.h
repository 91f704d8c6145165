// Finds which displacements are prescribed.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/elements/analysis_case.h"
#include "common/fem/elements/matrix_assembly.h"

namespace mortise::simulator {

// Prescribed displacements of nodes, along x, y, z or, at nodes that have a frame, along its axes.
struct Constraints {
  Eigen::Array3Xi fixed;          // 3 × nodes, 1 where prescribed
  Eigen::Matrix3Xd displacement;  // 3 × nodes, m, where prescribed; else zero
  NodeFrames frames;              // of nodes held in directions other than x, y and z
};

// Collects the supports of a checked case. INVALID_ARGUMENT naming the support if two prescribe
// different displacements at the same node.
absl::StatusOr<Constraints> CollectConstraints(const mesh::TetrahedralMesh& mesh,
                                               const std::vector<Support>& supports);

}  // namespace mortise::simulator
