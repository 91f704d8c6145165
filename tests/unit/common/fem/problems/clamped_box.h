// Boxes meshed in a regular way, clamped at one end and loaded at the other, for the linear
// solvers.
#pragma once

#include "common/fem/elements/material.h"
#include "tests/unit/common/fem/problems/structured_mesh.h"

namespace mortise::simulator {

// A box from the origin to `size`, m, each side divided into `cells`, each cell into six
// tetrahedra. Inner nodes are moved a little, so that no two elements are alike.
inline mesh::TetrahedralMesh BoxMesh(const Eigen::Vector3d& size, const Eigen::Vector3i& cells,
                                     bool quadratic) {
  mesh::MappedBox box;
  for (int k = 0; k < 3; ++k) box.ticks[k] = mesh::Ticks(cells[k]);
  box.place = [size](const Eigen::Vector3d& uvw) -> Eigen::Vector3d {
    return size.cwiseProduct(uvw);
  };
  mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(box, quadratic);
  mesh::Shake(mesh, 0.05 * (size.array() / cells.cast<double>().array()).minCoeff(), 7);
  return mesh;
}

// Non-zero for all displacements of nodes at x = 0; 3 × nodes.
inline Eigen::Array3Xi ClampedEnd(const mesh::TetrahedralMesh& mesh) {
  const double least = 1e-9 * mesh.nodes.row(0).maxCoeff();
  return (mesh.nodes.row(0).array() < least).cast<int>().replicate(3, 1);
}

// 1000 N downwards, shared by the nodes where x is largest; 3 × nodes.
inline Eigen::Matrix3Xd EndLoad(const mesh::TetrahedralMesh& mesh) {
  const double length = mesh.nodes.row(0).maxCoeff();
  const Eigen::Array<bool, 1, Eigen::Dynamic> end = mesh.nodes.row(0).array() > (1 - 1e-9) * length;
  Eigen::Matrix3Xd load = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  load.row(2) = -1000 * end.cast<double>().matrix() / static_cast<double>(end.count());
  return load;
}

inline Material Steel() {
  Material steel;
  steel.name = "steel";
  steel.density = 7850;
  steel.youngs_modulus = 210e9;
  steel.poissons_ratio = 0.3;
  return steel;
}

}  // namespace mortise::simulator
