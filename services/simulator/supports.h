// Which displacements are prescribed, and whether they hold every part.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "services/simulator/analysis_case.h"
#include "services/simulator/assembly.h"

namespace mortise::simulator {

// Prescribed displacements of nodes, along x, y, z or, of nodes that have a frame, along its axes.
struct Constraints {
  Eigen::Array3Xi fixed;          // 3 × nodes, 1 where prescribed
  Eigen::Matrix3Xd displacement;  // 3 × nodes, m, where prescribed; else zero
  NodeFrames frames;              // of nodes held in directions other than x, y and z
};

// Collects the supports of a checked case. INVALID_ARGUMENT naming the support if two prescribe
// different displacements at the same node.
absl::StatusOr<Constraints> CollectConstraints(const mesh::TetrahedralMesh& mesh,
                                               const std::vector<Support>& supports);

// FAILED_PRECONDITION, reason RIGID_MOTION, if something can move without deforming, naming the
// parts and the motion: "part 'leg 3' is free to rotate about z". Each set of connected elements
// must be held against three translations and three rotations; those possible are the null space of
// the supports' action on them.
absl::Status CheckRigidMotion(const mesh::TetrahedralMesh& mesh, const Constraints& constraints);

// The rigid motions that the supports leave: each a displacement of all nodes (3 × nodes, in
// space), linearly independent; none if everything is held.
std::vector<Eigen::Matrix3Xd> RigidMotions(const mesh::TetrahedralMesh& mesh,
                                           const Constraints& constraints);

}  // namespace mortise::simulator
