// Says how the nodes of a mesh move with the parameters of a design while its elements stay the
// same.
//
// Each face says how its plane moves; nodes on it do not leave it, and those on edges and corners
// not any of their faces. Along faces, and in the volume, nodes follow as those of an elastic body
// that is moved so at its surface: one factorisation, whatever the number of parameters. Gradients
// of what is computed on a mesh depend on how the surface moves alone, but for the error of the
// discretisation.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// The motion of a plane face between two lines across it, linear from one to the other; of a face
// along coordinate planes both are the same, and only the velocity across it is prescribed.
struct FaceMotion {
  mesh::NamedFace face;
  std::array<bool, 3> prescribed{false, false, false};  // along which of x, y, z
  Eigen::Vector3d start = Eigen::Vector3d::Zero();      // m, a point of the first line
  Eigen::Vector3d to_end = Eigen::Vector3d::Zero();     // m, from there across to the other line
  Eigen::Matrix3Xd start_velocity = {};  // 3 × parameters, m per unit of the parameter
  Eigen::Matrix3Xd end_velocity = {};
};

// Returns the velocities of all nodes, 3 × nodes for each parameter. `motions`: of every face of
// every part. FAILED_PRECONDITION, reason MESH_MOTION, where faces that share nodes move apart:
// parts that stop touching, or touch otherwise; RESOURCE_EXHAUSTED beyond `memory_limit`, bytes.
absl::StatusOr<std::vector<Eigen::Matrix3Xd>> NodeVelocities(const mesh::TetrahedralMesh& mesh,
                                                             const std::vector<FaceMotion>& motions,
                                                             int parameters, double memory_limit);

}  // namespace mortise::simulator
