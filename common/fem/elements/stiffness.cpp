#include "common/fem/elements/stiffness.h"

#include <array>
#include <utility>

#include "common/base/errors.h"
#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

using Columns = Eigen::Matrix<double, 6, 3>;

// D B of a node with gradient g: the stress (rows) that unit displacements along x, y, z cause.
Columns StressOfNode(const Matrix6d& d, const Eigen::Vector3d& g) {
  Columns stress;
  stress.col(0) = g.x() * d.col(0) + g.y() * d.col(3) + g.z() * d.col(5);
  stress.col(1) = g.y() * d.col(1) + g.x() * d.col(3) + g.z() * d.col(4);
  stress.col(2) = g.z() * d.col(2) + g.y() * d.col(4) + g.x() * d.col(5);
  return stress;
}

// Adds Bᵀ S of a node with gradient g.
void AddForces(const Eigen::Vector3d& g, const Columns& s, Eigen::Matrix3d& block) {
  for (int c = 0; c < 3; ++c) {
    block(0, c) += g.x() * s(0, c) + g.y() * s(3, c) + g.z() * s(5, c);
    block(1, c) += g.y() * s(1, c) + g.x() * s(3, c) + g.z() * s(4, c);
    block(2, c) += g.z() * s(2, c) + g.y() * s(4, c) + g.x() * s(5, c);
  }
}

}  // namespace

absl::StatusOr<BlockMatrix> AssembleStiffness(const mesh::TetrahedralMesh& mesh,
                                              const std::vector<Material>& materials,
                                              const NodeFrames& frames, ThreadTeam& team) {
  MORTISE_RETURN_IF_ERROR(CheckMesh(mesh));
  std::vector<Matrix6d> stiffness;
  for (const Material& material : materials) stiffness.push_back(StiffnessMatrix(material));
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
  const auto kernel = [&](int e, Eigen::Matrix3d* blocks) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    const Matrix6d& d = stiffness[mesh.part[e]];
    const double longest = (positions.colwise() - Eigen::Vector3d(positions.col(0))).norm();
    for (const TetrahedronPoint& point : rule) {
      const ElementPoint geometry = EvaluateElement(positions, point.barycentric);
      if (!(geometry.determinant > 1e-14 * longest * longest * longest)) return false;
      const double volume = point.weight * geometry.determinant / 6;
      std::array<Columns, kMaximumNodes> stress;
      for (int b = 0; b < nodes; ++b) {
        stress[b] = volume * StressOfNode(d, geometry.gradients.col(b));
      }
      int k = 0;
      for (int a = 0; a < nodes; ++a) {
        const Eigen::Vector3d g = geometry.gradients.col(a);
        for (int b = a; b < nodes; ++b) AddForces(g, stress[b], blocks[k++]);
      }
    }
    return true;
  };
  BlockMatrix sum(mesh);
  MORTISE_RETURN_IF_ERROR(AssembleBlocks(mesh, frames, kernel, team, sum));
  return sum;
}

absl::StatusOr<BlockMatrix> AssembleStiffness(const mesh::TetrahedralMesh& mesh,
                                              const std::vector<Material>& materials) {
  ThreadTeam alone(1);
  return AssembleStiffness(mesh, materials, {}, alone);
}

absl::StatusOr<BlockMatrix> AssembleMass(const mesh::TetrahedralMesh& mesh,
                                         const std::vector<Material>& materials,
                                         const NodeFrames& frames,
                                         std::shared_ptr<const BlockPattern> pattern,
                                         ThreadTeam& team) {
  MORTISE_RETURN_IF_ERROR(CheckMesh(mesh));
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 5 : 2);
  const auto kernel = [&](int e, Eigen::Matrix3d* blocks) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    for (const TetrahedronPoint& point : rule) {
      const double determinant = EvaluateElement(positions, point.barycentric).determinant;
      if (!(determinant > 0)) return false;
      const double mass = materials[mesh.part[e]].density * point.weight * determinant / 6;
      const ShapeVector shape = TetrahedronShape(point.barycentric, nodes);
      int k = 0;
      for (int a = 0; a < nodes; ++a) {
        for (int b = a; b < nodes; ++b) {
          blocks[k++].diagonal().array() += mass * shape[a] * shape[b];
        }
      }
    }
    return true;
  };
  BlockMatrix sum(std::move(pattern));
  MORTISE_RETURN_IF_ERROR(AssembleBlocks(mesh, frames, kernel, team, sum));
  return sum;
}

}  // namespace mortise::simulator
