// Volume meshes of linear (4-node) or quadratic (10-node) tetrahedra.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Node order of a tetrahedron: corners 0-3 with positive volume (1-0, 2-0, 3-0 right-handed), then,
// for quadratic elements, the middles of edges 01, 12, 02, 03, 13, 23 (VTK's and Abaqus' order).
struct TetrahedralMesh {
  Eigen::Matrix3Xd nodes;      // 3 × N, metres
  Eigen::MatrixXi tetrahedra;  // 4 × E or 10 × E node indices
  Eigen::VectorXi part;        // E, index of the part each element belongs to

  // Triangles (3- or 6-node: corners, then middles of 01, 12, 20) that lie on faces of the
  // assembly.
  Eigen::MatrixXi face_triangles;  // 3 × F or 6 × F node indices, outward where on the outside
  Eigen::VectorXi face_triangle_face;  // F, index into `faces`
  std::vector<AssemblyFace> faces;
  std::vector<std::string> part_names;  // P

  bool IsQuadratic() const { return tetrahedra.rows() == 10; }
};

// Returns the same mesh with 10-node elements: a node in the middle of every edge. Quadratic meshes
// are returned as they are.
TetrahedralMesh MakeQuadratic(TetrahedralMesh mesh);

}  // namespace mortise::mesh
