// Turns back elements that are turned over, by moving single nodes. Private to this folder.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::interpolator {

// Moves free nodes of inverted elements to where the least volume of the elements around each, as a
// share of their volume in `mesh`, is largest (Freitag and Plassmann, Local optimization-based
// simplicial mesh untangling, 2000), until no element is inverted or nothing is won any more. This
// least volume never falls. `is_free`: of each node; the mesh has 4-node elements.
void Untangle(const mesh::TetrahedralMesh& mesh, const std::vector<bool>& is_free,
              Eigen::Matrix3Xd& nodes);

}  // namespace mortise::interpolator
