#include "services/simulator/stress_recovery.h"

#include <algorithm>
#include <cmath>

#include "common/mesh/element_faces.h"
#include "services/simulator/shape_functions.h"

namespace mortise::simulator {
namespace {

// A node as one part sees it.
struct NodeOfPart {
  int node;
  int part;
  friend auto operator<=>(const NodeOfPart&, const NodeOfPart&) = default;
};

std::vector<NodeOfPart> NodesOfParts(const mesh::TetrahedralMesh& mesh) {
  std::vector<NodeOfPart> all;
  all.reserve(mesh.tetrahedra.size());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    for (Eigen::Index k = 0; k < mesh.tetrahedra.rows(); ++k) {
      all.push_back({mesh.tetrahedra(k, e), mesh.part[e]});
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

Vector6d StressAt(const ElementPoint& point, const Eigen::Matrix<double, 3, Eigen::Dynamic>& u,
                  const Material& material) {
  const Eigen::Matrix3d gradient = u * point.gradients.transpose();
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const double pressure = material.Lambda() * strain.trace();
  const double twice_mu = 2 * material.Mu();
  Vector6d stress;
  stress << twice_mu * strain(0, 0) + pressure, twice_mu * strain(1, 1) + pressure,
      twice_mu * strain(2, 2) + pressure, twice_mu * strain(0, 1), twice_mu * strain(1, 2),
      twice_mu * strain(0, 2);
  return stress;
}

// Weights that carry values at the integration points linearly to each node: nodes × points.
Eigen::MatrixXd Extrapolation(int nodes) {
  const auto& rule = TetrahedronRule(nodes == 10 ? 2 : 1);
  const int points = static_cast<int>(rule.size());
  if (points == 1) return Eigen::MatrixXd::Ones(nodes, 1);
  // Point i has barycentric 1 − 3a at corner i and a elsewhere, so wᵢ(L) = (Lᵢ − a) / (1 − 4a).
  const double a = rule[0].barycentric[1];
  Eigen::MatrixXd weights(nodes, points);
  for (int n = 0; n < nodes; ++n) {
    Eigen::Vector4d l = Eigen::Vector4d::Zero();
    if (n < 4) {
      l[n] = 1;
    } else {
      l[mesh::kTetrahedronEdges[n - 4][0]] = l[mesh::kTetrahedronEdges[n - 4][1]] = 0.5;
    }
    weights.row(n) = ((l.array() - a) / (1 - 4 * a)).transpose();
  }
  return weights;
}

}  // namespace

NodalStress RecoverStress(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                          const Eigen::Matrix3Xd& displacement) {
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  const auto& rule = TetrahedronRule(nodes == 10 ? 2 : 1);
  const Eigen::MatrixXd extrapolation = Extrapolation(nodes);
  const std::vector<NodeOfPart> keys = NodesOfParts(mesh);
  Eigen::Matrix<double, 6, Eigen::Dynamic> sum(6, keys.size());
  sum.setZero();
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(keys.size());
  Eigen::Matrix<double, 6, Eigen::Dynamic> at_points(6, rule.size());
  Eigen::Matrix<double, 3, Eigen::Dynamic> u(3, nodes);
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    for (int k = 0; k < nodes; ++k) u.col(k) = displacement.col(mesh.tetrahedra(k, e));
    double volume = 0;
    for (std::size_t p = 0; p < rule.size(); ++p) {
      const ElementPoint point = EvaluateElement(positions, rule[p].barycentric);
      volume += rule[p].weight * point.determinant / 6;
      at_points.col(p) = StressAt(point, u, materials[mesh.part[e]]);
    }
    for (int k = 0; k < nodes; ++k) {
      const auto found = std::lower_bound(keys.begin(), keys.end(),
                                          NodeOfPart{mesh.tetrahedra(k, e), mesh.part[e]});
      const Eigen::Index slot = found - keys.begin();
      sum.col(slot) += volume * (at_points * extrapolation.row(k).transpose());
      weight[slot] += volume;
    }
  }
  NodalStress result;
  result.stress = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, mesh.nodes.cols());
  result.von_mises = Eigen::VectorXd::Constant(mesh.nodes.cols(), 0);
  result.part_maximum = Eigen::VectorXd::Zero(mesh.part_names.size());
  for (std::size_t slot = 0; slot < keys.size(); ++slot) {
    const Vector6d stress = sum.col(slot) / weight[slot];
    const double equivalent = VonMises(stress);
    double& maximum = result.part_maximum[keys[slot].part];
    maximum = std::max(maximum, equivalent);
    if (equivalent < result.von_mises[keys[slot].node]) continue;
    result.von_mises[keys[slot].node] = equivalent;
    result.stress.col(keys[slot].node) = stress;
  }
  return result;
}

}  // namespace mortise::simulator
