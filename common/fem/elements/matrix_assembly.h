// Assembles sparse matrices from the matrices of elements.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "absl/status/status.h"
#include "common/fem/linear/block_matrix.h"
#include "common/fem/linear/node_frames.h"
#include "common/fem/linear/thread_team.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// Writes the blocks of the symmetric matrix of element `e` on and above the diagonal, row by row
// ((0,0), (0,1) … (1,1) …, zero before); false if the element is inverted or has no volume. It is
// called from several threads.
using ElementKernel = std::function<bool(int e, Eigen::Matrix3d* blocks)>;

// Fails with INVALID_ARGUMENT naming "tetrahedra", "nodes" or "part" unless the arrays of the mesh
// fit together and are finite.
absl::Status CheckMesh(const mesh::TetrahedralMesh& mesh);

// Adds the matrices of all elements to `sum`, which has the mesh's pattern; the same to the bit for
// any number of threads. INVALID_ARGUMENT naming "tetrahedra[e]", its part and place if the kernel
// refuses an element. The mesh has been checked.
absl::Status AssembleBlocks(const mesh::TetrahedralMesh& mesh, const NodeFrames& frames,
                            const ElementKernel& kernel, ThreadTeam& team, BlockMatrix& sum);

}  // namespace mortise::simulator
