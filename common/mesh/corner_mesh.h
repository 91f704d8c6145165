// The linear elements between the corners of a mesh, for what needs no more than these.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::mesh {

struct CornerMesh {
  TetrahedralMesh mesh;        // 4-node elements of one part, without faces
  std::vector<int> corner_of;  // for each node of the whole mesh: its index here, or −1
};

// Returns the corners, in the order in which elements name them first, and the same elements
// between them.
CornerMesh CornersOf(const TetrahedralMesh& mesh);

// Returns what corners have, 3 × corners, for all nodes of the whole mesh: middles of edges have
// the mean of their ends, nodes that no element names 0.
Eigen::Matrix3Xd AtAllNodes(const TetrahedralMesh& mesh, const CornerMesh& corners,
                            const Eigen::Matrix3Xd& at_corners);

}  // namespace mortise::mesh
