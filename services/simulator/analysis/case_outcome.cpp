#include "services/simulator/analysis/case_outcome.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/design/metric_registry.h"
#include "common/mesh/files/vtu_writer.h"

namespace mortise::simulator {

CaseOutcome OutcomeOf(const std::string& name, const mesh::TetrahedralMesh& mesh,
                      const ElasticitySolution& solution, double relative_error,
                      const StressSpread& spread,
                      const std::vector<std::vector<int>>& support_nodes) {
  CaseOutcome outcome;
  outcome.name = name;
  outcome.summary = solution.summary;
  Eigen::Index worst = 0;
  outcome.maximum_von_mises = solution.von_mises.maxCoeff(&worst);
  outcome.maximum_von_mises_at = mesh.nodes.col(worst);
  outcome.maximum_displacement_at = mesh.nodes.col(solution.summary.maximum_displacement_node);
  outcome.maximum_principal = solution.maximum_principal.maxCoeff();
  outcome.mean_von_mises = spread.Mean();
  outcome.rms_von_mises = spread.RootMeanSquare();
  outcome.von_mises_p99 = spread.Percentile(kShareBelowP99);
  outcome.von_mises_integral = spread.Integral();
  outcome.relative_error = relative_error;
  outcome.part_maximum_von_mises = solution.part_maximum_von_mises;
  outcome.part_safety_factor = solution.part_safety_factor;
  for (const std::vector<int>& nodes : support_nodes) {
    Eigen::Vector3d& sum = outcome.reactions.emplace_back(Eigen::Vector3d::Zero());
    for (const int v : nodes) sum += solution.reaction.col(v);
  }
  return outcome;
}

HeatOutcome OutcomeOf(const HeatSolution& solution) {
  return {.minimum = solution.minimum,
          .maximum = solution.maximum,
          .supplied = solution.supplied,
          .through_temperatures = solution.reaction.sum(),
          .convected = {solution.convected.begin(), solution.convected.end()}};
}

// The sum of squares is what grows most.
bool IsFinite(const StressSpread& spread) { return std::isfinite(spread.RootMeanSquare()); }

bool IsFinite(const ElasticitySolution& solution) {
  const ElasticitySummary& summary = solution.summary;
  return std::isfinite(summary.strain_energy + summary.compliance) &&
         std::isfinite(summary.maximum_displacement) && solution.stress.allFinite() &&
         solution.von_mises.allFinite() && solution.reaction.allFinite() &&
         summary.total_load.allFinite();
}

bool IsFinite(const HeatSolution& solution) {
  return std::isfinite(solution.supplied + solution.reaction.sum() + solution.convected.sum() +
                       (solution.maximum - solution.minimum));
}

std::vector<std::vector<int>> NodesOf(const mesh::TetrahedralMesh& mesh,
                                      const std::vector<Support>& supports) {
  std::vector<std::vector<int>> nodes;
  for (const Support& support : supports) {
    std::vector<int>& of = nodes.emplace_back(support.nodes);
    if (!support.face.name.empty()) {
      of.clear();
      for (const int t : TrianglesOn(mesh, support.face, false)) {
        const auto corners = mesh.face_triangles.col(t);
        of.insert(of.end(), corners.begin(), corners.end());
      }
    }
    std::sort(of.begin(), of.end());
    of.erase(std::unique(of.begin(), of.end()), of.end());
  }
  return nodes;
}

std::string FileStem(std::size_t number, const std::string& name) {
  std::string plain = absl::StrCat(number);
  bool gap = true;
  for (const char c : name.substr(0, 60)) {
    const bool keep = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (keep && gap) plain += '-';
    if (keep) plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    gap = !keep;
  }
  return plain;
}

absl::StatusOr<std::string> WriteFields(const mesh::TetrahedralMesh& mesh,
                                        const ElasticitySolution& solution,
                                        const Eigen::VectorXd& element_error,
                                        double reference_temperature) {
  std::vector<mesh::VtuField> at_nodes{
      {"displacement (m)", solution.displacement},
      {"von Mises stress (Pa)", solution.von_mises.transpose()},
      {"stress (Pa)", solution.stress},
      {"maximum principal stress (Pa)", solution.maximum_principal.transpose()},
      {"reaction (N)", solution.reaction}};
  if (solution.temperature.size() > 0) {
    const Eigen::VectorXd temperature = solution.temperature.array() + reference_temperature;
    at_nodes.push_back({"temperature", temperature.transpose()});
  }
  return mesh::WriteVtu(mesh, at_nodes,
                        {{"error of the stress (J^1/2)", element_error.transpose()}});
}

Eigen::Matrix3Xd ElementHeatFlux(const mesh::TetrahedralMesh& mesh,
                                 const std::vector<Material>& materials,
                                 const Eigen::VectorXd& temperature) {
  const Eigen::Matrix3Xd at_points = HeatFluxAtPoints(mesh, materials, temperature);
  const Eigen::Index points = at_points.cols() / mesh.tetrahedra.cols();
  Eigen::Matrix3Xd flux(3, mesh.tetrahedra.cols());
  for (Eigen::Index e = 0; e < flux.cols(); ++e) {
    flux.col(e) = at_points.middleCols(e * points, points).rowwise().mean();
  }
  return flux;
}

absl::StatusOr<std::string> WriteHeat(const mesh::TetrahedralMesh& mesh,
                                      const std::vector<Material>& materials,
                                      const Eigen::VectorXd& temperature) {
  return mesh::WriteVtu(mesh, {{"temperature", temperature.transpose()}},
                        {{"heat flux (W/m^2)", ElementHeatFlux(mesh, materials, temperature)}});
}

}  // namespace mortise::simulator
