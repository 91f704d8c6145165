#include "common/mesh/corner_mesh.h"

#include "common/mesh/element_faces.h"

namespace mortise::mesh {

CornerMesh CornersOf(const TetrahedralMesh& mesh) {
  CornerMesh corners;
  corners.corner_of.assign(static_cast<std::size_t>(mesh.nodes.cols()), -1);
  corners.mesh.tetrahedra.resize(4, mesh.tetrahedra.cols());
  corners.mesh.nodes.resize(3, mesh.nodes.cols());
  corners.mesh.part = Eigen::VectorXi::Zero(mesh.tetrahedra.cols());
  corners.mesh.part_names = {"body"};
  int count = 0;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    for (int k = 0; k < 4; ++k) {
      const int node = mesh.tetrahedra(k, e);
      int& corner = corners.corner_of[static_cast<std::size_t>(node)];
      if (corner < 0) {
        corner = count++;
        corners.mesh.nodes.col(corner) = mesh.nodes.col(node);
      }
      corners.mesh.tetrahedra(k, e) = corner;
    }
  }
  corners.mesh.nodes.conservativeResize(Eigen::NoChange, count);
  return corners;
}

Eigen::Matrix3Xd AtAllNodes(const TetrahedralMesh& mesh, const CornerMesh& corners,
                            const Eigen::Matrix3Xd& at_corners) {
  Eigen::Matrix3Xd values = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  for (Eigen::Index node = 0; node < mesh.nodes.cols(); ++node) {
    const int corner = corners.corner_of[static_cast<std::size_t>(node)];
    if (corner >= 0) values.col(node) = at_corners.col(corner);
  }
  if (!mesh.IsQuadratic()) return values;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    for (std::size_t k = 0; k < kTetrahedronEdges.size(); ++k) {
      const auto& [from, to] = kTetrahedronEdges[k];
      values.col(mesh.tetrahedra(4 + static_cast<Eigen::Index>(k), e)) =
          (values.col(mesh.tetrahedra(from, e)) + values.col(mesh.tetrahedra(to, e))) / 2;
    }
  }
  return values;
}

}  // namespace mortise::mesh
