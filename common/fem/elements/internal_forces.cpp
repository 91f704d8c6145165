#include "common/fem/elements/internal_forces.h"

#include <algorithm>

#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

// Elements whose forces are computed at once, before they are added up in order.
constexpr Eigen::Index kBatch = 1 << 16;

}  // namespace

Eigen::Matrix3Xd InternalForces(const mesh::TetrahedralMesh& mesh,
                                const std::vector<Material>& materials,
                                const Eigen::Matrix3Xd& displacement, ThreadTeam& team) {
  std::vector<Matrix6d> stiffness;
  for (const Material& material : materials) stiffness.push_back(StiffnessMatrix(material));
  const Eigen::Index nodes = mesh.tetrahedra.rows(), elements = mesh.tetrahedra.cols();
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
  Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  Eigen::Matrix3Xd forces(3, nodes * std::min(kBatch, elements));
  for (Eigen::Index first = 0; first < elements; first += kBatch) {
    const Eigen::Index count = std::min(kBatch, elements - first);
    team.ForRanges(static_cast<int>(count), [&](int begin, int end) {
      GradientMatrix u(3, nodes);
      for (Eigen::Index k = begin; k < end; ++k) {
        const Eigen::Index e = first + k;
        const GradientMatrix positions = ElementPositions(mesh, e);
        for (Eigen::Index a = 0; a < nodes; ++a) {
          u.col(a) =
              displacement.col(mesh.tetrahedra(a, e)) - displacement.col(mesh.tetrahedra(0, e));
        }
        auto own = forces.middleCols(nodes * k, nodes);
        own.setZero();
        for (const TetrahedronPoint& point : rule) {
          const ElementPoint geometry = EvaluateElement(positions, point.barycentric);
          const Vector6d stress =
              stiffness[mesh.part[e]] * StrainOf(u * geometry.gradients.transpose());
          own +=
              point.weight * geometry.determinant / 6 * StressTensor(stress) * geometry.gradients;
        }
        // The forces of an element are in balance.
        own.col(0) = -own.rightCols(nodes - 1).rowwise().sum();
      }
    });
    for (Eigen::Index k = 0; k < count; ++k) {
      for (Eigen::Index a = 0; a < nodes; ++a) {
        sum.col(mesh.tetrahedra(a, first + k)) += forces.col(nodes * k + a);
      }
    }
  }
  return sum;
}

}  // namespace mortise::simulator
