#include "common/fem/stress/error_estimate.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/fem/elements/shape_functions.h"
#include "common/fem/stress/element_stress.h"
#include "common/fem/stress/part_surface.h"
#include "common/fem/stress/stress_recovery.h"

namespace mortise::simulator {

ErrorEstimate EstimateError(const mesh::TetrahedralMesh& mesh,
                            const std::vector<Material>& materials,
                            const Eigen::Matrix3Xd& displacement,
                            const Eigen::VectorXd& temperature, ThreadTeam& team,
                            const SurfaceTraction& traction) {
  const PartNodes part_nodes(mesh);
  const PartSurface surface(mesh, part_nodes);
  const Stresses smooth = RecoverAtSlots({mesh, materials, displacement, temperature, traction},
                                         part_nodes, surface, team);
  std::vector<Matrix6d> compliance;
  for (const Material& material : materials) {
    compliance.push_back(StiffnessMatrix(material).inverse());
  }
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  const int elements = static_cast<int>(mesh.tetrahedra.cols());
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 5 : 2);
  Eigen::VectorXd error(elements), energy(elements);  // both squared
  team.ForRanges(elements, [&](int begin, int end) {
    ElementStress stress(mesh, materials, displacement, temperature);
    Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaximumNodes> recovered(6, nodes);
    for (int e = begin; e < end; ++e) {
      stress.MoveTo(e);
      for (int k = 0; k < nodes; ++k) {
        recovered.col(k) = smooth.col(part_nodes.element_slots()(k, e));
      }
      const int part = mesh.part[e];
      error[e] = energy[e] = 0;
      for (const TetrahedronPoint& at : rule) {
        const ElementPoint point = EvaluateElement(stress.positions(), at.barycentric);
        const ShapeVector shape = TetrahedronShape(at.barycentric, nodes);
        const double volume = at.weight * point.determinant / 6;
        const Vector6d own = stress.At(point, at.barycentric);
        const Vector6d difference = recovered * shape - own;
        error[e] += volume * difference.dot(compliance[part] * difference);
        energy[e] += volume * own.dot(compliance[part] * own);
      }
    }
  });
  ErrorEstimate estimate;
  estimate.error = std::sqrt(error.sum());
  estimate.energy_norm = std::sqrt(energy.sum());
  const double whole = std::hypot(estimate.error, estimate.energy_norm);
  estimate.relative = whole > 0 ? estimate.error / whole : 0;
  estimate.element_error = error.cwiseSqrt();
  return estimate;
}

Eigen::VectorXd ElementSizes(const mesh::TetrahedralMesh& mesh, const ErrorEstimate& estimate,
                             double wanted) {
  const double degree = mesh.IsQuadratic() ? 2 : 1;
  const Eigen::Index elements = mesh.tetrahedra.cols();
  const double allowed = wanted * std::hypot(estimate.error, estimate.energy_norm);
  // An element of error η becomes f times as large: its place then has the error η f^p and f^-3
  // elements. Their number is least, for Σ η² f^2p = allowed², where f = c η^(-2 / (2p + 3)).
  const double power = 2 / (2 * degree + 3);
  double sum = 0;
  for (const double error : estimate.element_error) sum += std::pow(error, 3 * power);
  const double scale = sum > 0 ? std::pow(allowed * allowed / sum, 1 / (2 * degree)) : 0;
  Eigen::VectorXd sizes(elements);
  for (Eigen::Index e = 0; e < elements; ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    // The edge of a regular tetrahedron of the same volume.
    const double volume =
        EvaluateElement(positions, Eigen::Vector4d::Constant(0.25)).determinant / 6;
    const double size = std::cbrt(6 * std::sqrt(2.0) * std::max(volume, 0.0));
    const double error = estimate.element_error[e];
    const double factor = error > 0 ? scale * std::pow(error, -power) : 2;
    sizes[e] = size * std::clamp(factor, 0.2, 2.0);
  }
  return sizes;
}

}  // namespace mortise::simulator
