// Mesh files as other programs write them, and a box to put into them.
#pragma once

#include <Eigen/Core>
#include <string>

#include "common/mesh/files/grouped_mesh.h"

namespace mortise::testing {

// A box from the origin to `size`, in cells of six tetrahedra each. Groups of elements: "low" and
// "high", the halves in x (the number of cells along x is even); of faces: "x_min", "x_max" …; of
// nodes: "tip", those at x_max, and "origin". Numbers are neither in a row nor do they begin at 1.
mesh::GroupedMesh GroupedBox(const Eigen::Vector3d& size, const Eigen::Vector3i& cells,
                             bool quadratic);

// The mesh as Gmsh writes it: groups of elements, faces and nodes are physical groups of volumes,
// surfaces and points. No element may be in two groups in version 4.1.
std::string WriteGmsh22(const mesh::GroupedMesh& mesh, bool is_binary);
std::string WriteGmsh41(const mesh::GroupedMesh& mesh, bool is_binary);

// The mesh as input of Abaqus or CalculiX.
std::string WriteAbaqus(const mesh::GroupedMesh& mesh);

}  // namespace mortise::testing
