#include "common/fem/stress/element_stress.h"

namespace mortise::simulator {

ElementStress::ElementStress(const mesh::TetrahedralMesh& mesh,
                             const std::vector<Material>& materials,
                             const Eigen::Matrix3Xd& displacement,
                             const Eigen::VectorXd& temperature)
    : mesh_(mesh),
      displacement_(displacement),
      temperature_(temperature),
      u_(3, mesh.tetrahedra.rows()),
      warmth_(temperature.size() > 0 ? mesh.tetrahedra.rows() : 0) {
  for (const Material& material : materials) {
    stiffness_.push_back(StiffnessMatrix(material));
    expansion_.push_back(ThermalStrain(material));
  }
}

void ElementStress::MoveTo(Eigen::Index element) {
  part_ = static_cast<std::size_t>(mesh_.part[element]);
  positions_ = ElementPositions(mesh_, element);
  for (Eigen::Index k = 0; k < u_.cols(); ++k) {
    const int node = mesh_.tetrahedra(k, element);
    u_.col(k) = displacement_.col(node);
    if (warmth_.size() > 0) warmth_[k] = temperature_[node];
  }
}

Vector6d ElementStress::At(const ElementPoint& point, const Eigen::Vector4d& barycentric) const {
  Vector6d strain = StrainOf(DisplacementGradient(point));
  if (warmth_.size() > 0) {
    const int nodes = static_cast<int>(warmth_.size());
    strain -= TetrahedronShape(barycentric, nodes).dot(warmth_) * expansion_[part_];
  }
  return stiffness_[part_] * strain;
}

}  // namespace mortise::simulator
