// Which displacements are prescribed, and whether they hold every part.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/simulator/analysis_case.h"

namespace mortise::simulator {

// Prescribed displacements of nodes.
struct Constraints {
  Eigen::Array3Xi fixed;          // 3 × nodes, 1 where prescribed
  Eigen::Matrix3Xd displacement;  // 3 × nodes, m, where prescribed
};

// Collects the supports of a checked case. INVALID_ARGUMENT naming the support if two prescribe
// different displacements at the same node.
absl::StatusOr<Constraints> CollectConstraints(const mesh::TetrahedralMesh& mesh,
                                               const AnalysisCase& analysis);

// FAILED_PRECONDITION, reason RIGID_MOTION, if something can move without deforming, naming the
// parts and the motion: "part 'leg 3' is free to rotate about z". Each set of connected elements
// must be held against three translations and three rotations; those possible are the null space of
// the supports' action on them.
absl::Status CheckRigidMotion(const mesh::TetrahedralMesh& mesh, const Constraints& constraints);

}  // namespace mortise::simulator
