// Meshes of mapped boxes, for problems whose solution is known: they need no mesher, and curved
// edges of quadratic elements lie on the true shape.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::mesh {

// A box 0 … 1 in three directions u, v, w, divided at `ticks` (ascending, first 0 and last 1), and
// where its points lie in space.
struct MappedBox {
  std::array<std::vector<double>, 3> ticks;
  std::function<Eigen::Vector3d(const Eigen::Vector3d& uvw)> place;
};

// n + 1 ticks from 0 to 1 whose steps grow by a constant factor, the last `ratio` times the first.
std::vector<double> Ticks(int n, double ratio = 1);

// Six tetrahedra a cell, all along the same diagonal; middle nodes at the place of the middle in
// u, v, w. Its one part is "body"; its faces are u_min, u_max, v_min, v_max, w_min, w_max.
TetrahedralMesh MeshMappedBox(const MappedBox& box, bool quadratic);

// Nodes whose place in u, v, w satisfies a condition. The order is that of the mesh.
std::vector<int> NodesWhere(const MappedBox& box, bool quadratic,
                            const std::function<bool(const Eigen::Vector3d& uvw)>& condition);

// Moves each inner node by up to `distance` (m) along each axis, the same way for the same seed, so
// that no two elements are alike.
void Shake(TetrahedralMesh& mesh, double distance, unsigned seed);

}  // namespace mortise::mesh
