#include "common/fem/stress/stress_recovery.h"

#include <algorithm>
#include <cmath>

#include "common/fem/elements/shape_functions.h"
#include "common/fem/stress/element_stress.h"

namespace mortise::simulator {

Stresses StressAtPoints(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                        const Eigen::Matrix3Xd& displacement, const Eigen::VectorXd& temperature,
                        ThreadTeam& team) {
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
  const Eigen::Index points = static_cast<Eigen::Index>(rule.size());
  Stresses stress(6, points * mesh.tetrahedra.cols());
  team.ForRanges(static_cast<int>(mesh.tetrahedra.cols()), [&](int begin, int end) {
    ElementStress of_element(mesh, materials, displacement, temperature);
    for (Eigen::Index e = begin; e < end; ++e) {
      of_element.MoveTo(e);
      for (Eigen::Index p = 0; p < points; ++p) {
        const ElementPoint point = EvaluateElement(of_element.positions(), rule[p].barycentric);
        stress.col(points * e + p) = of_element.At(point, rule[p].barycentric);
      }
    }
  });
  return stress;
}

Stresses RecoverAtSlots(const DeformedBody& body, const PartNodes& nodes,
                        const PartSurface& surface, ThreadTeam& team) {
  Stresses recovered = RecoverByPatches(
      body.mesh, nodes, surface,
      StressAtPoints(body.mesh, body.materials, body.displacement, body.temperature, team), team);
  const SurfaceStress on_surface(body, surface);
  team.ForRanges(nodes.size(), [&](int begin, int end) {
    for (int slot = begin; slot < end; ++slot) {
      if (const auto stress = on_surface.At(slot, nodes.node(slot))) recovered.col(slot) = *stress;
    }
  });
  return recovered;
}

NodalStress RecoverStress(const DeformedBody& body, const PartNodes& nodes,
                          const PartSurface& surface, ThreadTeam& team) {
  const mesh::TetrahedralMesh& mesh = body.mesh;
  const Stresses recovered = RecoverAtSlots(body, nodes, surface, team);
  NodalStress result;
  result.stress = Stresses::Zero(6, mesh.nodes.cols());
  result.von_mises = Eigen::VectorXd::Zero(mesh.nodes.cols());
  result.part_maximum = Eigen::VectorXd::Zero(mesh.part_names.size());
  for (int slot = 0; slot < nodes.size(); ++slot) {
    const Vector6d stress = recovered.col(slot);
    const double equivalent = VonMises(stress);
    double& maximum = result.part_maximum[nodes.part(slot)];
    maximum = std::max(maximum, equivalent);
    if (equivalent < result.von_mises[nodes.node(slot)]) continue;
    result.von_mises[nodes.node(slot)] = equivalent;
    result.stress.col(nodes.node(slot)) = stress;
  }
  result.maximum_principal.resize(mesh.nodes.cols());
  team.ForRanges(static_cast<int>(mesh.nodes.cols()), [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      result.maximum_principal[v] = MaximumPrincipal(result.stress.col(v));
    }
  });
  return result;
}

}  // namespace mortise::simulator
