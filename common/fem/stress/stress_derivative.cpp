#include "common/fem/stress/stress_derivative.h"

#include <Eigen/Eigenvalues>

#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {

StressDerivative NodalStressDerivative(const DeformedBody& body, const PartNodes& nodes,
                                       const PartSurface& surface, const Stresses& at_points,
                                       int slot, const Vector6d& direction) {
  const mesh::TetrahedralMesh& mesh = body.mesh;
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  StressDerivative derivative{0, none, none};
  if (SurfaceStress(body, surface).AddDerivative(slot, direction, derivative)) return derivative;
  const RecoveredValue recovered =
      RecoverAt(mesh, nodes, surface, slot, at_points.transpose() * direction);
  derivative.value = recovered.value;
  // With S = D direction, direction · σ of a point is S : ∇u.
  const Eigen::Matrix3d sensitivity = StressTensor(
      StiffnessMatrix(body.materials[static_cast<std::size_t>(nodes.part(slot))]) * direction);
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
  const int per_element = static_cast<int>(rule.size());
  for (std::size_t i = 0; i < recovered.points.size(); ++i) {
    const int e = recovered.points[i] / per_element;
    const auto& barycentric =
        rule[static_cast<std::size_t>(recovered.points[i] % per_element)].barycentric;
    const GradientMatrix positions = ElementPositions(mesh, e);
    const ElementPoint at = EvaluateElement(positions, barycentric);
    const ShapeVector shape = TetrahedronShape(barycentric, static_cast<int>(positions.cols()));
    Eigen::Matrix3d by_u = Eigen::Matrix3d::Zero();  // ∇u
    for (Eigen::Index a = 0; a < positions.cols(); ++a) {
      by_u += body.displacement.col(mesh.tetrahedra(a, e)) * at.gradients.col(a).transpose();
    }
    for (Eigen::Index a = 0; a < positions.cols(); ++a) {
      const int node = mesh.tetrahedra(a, e);
      const Eigen::Vector3d pull = recovered.weights[i] * sensitivity * at.gradients.col(a);
      derivative.by_displacement.col(node) += pull;
      // δ(∇u) = −∇u ∇V, and the point itself moves along.
      derivative.by_position.col(node) +=
          shape[a] * recovered.by_place.col(static_cast<Eigen::Index>(i)) - by_u.transpose() * pull;
    }
  }
  derivative.by_position.col(nodes.node(slot)) += recovered.by_node;
  return derivative;
}

Vector6d VonMisesGradient(const Vector6d& stress) {
  const double equivalent = VonMises(stress);
  if (!(equivalent > 0)) return Vector6d::Zero();
  const double mean = stress.head<3>().mean();
  Vector6d gradient;
  gradient << 1.5 * (stress.head<3>().array() - mean), 3 * stress.tail<3>();
  return gradient / equivalent;
}

Vector6d MaximumPrincipalGradient(const Vector6d& stress) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(StressTensor(stress));
  const Eigen::Vector3d n = principal.eigenvectors().col(2);
  Vector6d gradient;
  gradient << n.cwiseAbs2(), 2 * n.x() * n.y(), 2 * n.y() * n.z(), 2 * n.x() * n.z();
  return gradient;
}

}  // namespace mortise::simulator
