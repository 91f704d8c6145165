#include "services/simulator/stiffness.h"

#include <Eigen/Geometry>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "services/simulator/shape_functions.h"

namespace mortise::simulator {
namespace {

absl::Status BadElement(const mesh::TetrahedralMesh& mesh, Eigen::Index e) {
  const Eigen::Vector3d place = 1e3 * ElementPositions(mesh, e).leftCols(4).rowwise().mean();
  return InvalidField(
      absl::StrFormat("tetrahedra[%d]", e),
      absl::StrFormat("the element of part '%s' at (%.4g, %.4g, %.4g) mm is inverted or flat",
                      mesh.part_names[mesh.part[e]], place.x(), place.y(), place.z()));
}

absl::Status CheckMesh(const mesh::TetrahedralMesh& mesh) {
  const Eigen::Index rows = mesh.tetrahedra.rows();
  if (mesh.tetrahedra.cols() == 0 || (rows != 4 && rows != 10)) {
    return InvalidField("tetrahedra", "there must be elements, of 4 or 10 nodes");
  }
  if (mesh.tetrahedra.minCoeff() < 0 || mesh.tetrahedra.maxCoeff() >= mesh.nodes.cols()) {
    return InvalidField("tetrahedra", "an element names a node that does not exist");
  }
  if (!mesh.nodes.allFinite()) return InvalidField("nodes", "a coordinate is not finite");
  if (mesh.part.size() != mesh.tetrahedra.cols() || mesh.part.minCoeff() < 0 ||
      mesh.part.maxCoeff() >= static_cast<int>(mesh.part_names.size())) {
    return InvalidField("part", "every element must belong to a part");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<BlockMatrix> AssembleStiffness(const mesh::TetrahedralMesh& mesh,
                                              const std::vector<Material>& materials) {
  MORTISE_RETURN_IF_ERROR(CheckMesh(mesh));
  BlockMatrix stiffness(mesh);
  const int corners = static_cast<int>(mesh.tetrahedra.rows());
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
  std::array<std::array<Eigen::Matrix3d, kMaximumNodes>, kMaximumNodes> block;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    const double lambda = materials[mesh.part[e]].Lambda(), mu = materials[mesh.part[e]].Mu();
    for (int a = 0; a < corners; ++a) {
      for (int b = a; b < corners; ++b) block[a][b].setZero();
    }
    const double longest = (positions.colwise() - Eigen::Vector3d(positions.col(0))).norm();
    for (const TetrahedronPoint& point : rule) {
      const ElementPoint geometry = EvaluateElement(positions, point.barycentric);
      if (!(geometry.determinant > 1e-14 * longest * longest * longest)) {
        return BadElement(mesh, e);
      }
      const double volume = point.weight * geometry.determinant / 6;
      const GradientMatrix& g = geometry.gradients;
      for (int a = 0; a < corners; ++a) {
        for (int b = a; b < corners; ++b) {
          // Bₐᵀ D B_b of an isotropic material: λ gₐ g_bᵀ + μ g_b gₐᵀ + μ (gₐ·g_b) I.
          const Eigen::Matrix3d outer = g.col(a) * g.col(b).transpose();
          block[a][b] += volume * (lambda * outer + mu * outer.transpose());
          block[a][b].diagonal().array() += volume * mu * outer.trace();
        }
      }
    }
    for (int a = 0; a < corners; ++a) {
      for (int b = a; b < corners; ++b) {
        const int i = mesh.tetrahedra(a, e), j = mesh.tetrahedra(b, e);
        if (i <= j) {
          stiffness.Add(i, j, block[a][b]);
        } else {
          stiffness.Add(j, i, block[a][b].transpose());
        }
      }
    }
  }
  return stiffness;
}

}  // namespace mortise::simulator
