// Tells what load cases and heat come to, of designs and of uploaded meshes alike: the numbers that
// are told of each, and the fields that are shown.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/problems/elasticity.h"
#include "common/fem/problems/heat_conduction.h"
#include "common/fem/stress/error_estimate.h"
#include "common/fem/stress/stress_spread.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// The outcome of a load case or a combination.
struct CaseOutcome {
  std::string name;
  ElasticitySummary summary;
  double maximum_von_mises = 0;                                       // Pa
  Eigen::Vector3d maximum_von_mises_at = Eigen::Vector3d::Zero();     // m
  Eigen::Vector3d maximum_displacement_at = Eigen::Vector3d::Zero();  // m
  double maximum_principal = 0;                                       // Pa
  // Of the von Mises stress over the volume:
  double mean_von_mises = 0, rms_von_mises = 0;  // Pa
  double von_mises_p99 = 0;                      // Pa: 99 % of the volume is below it
  double von_mises_integral = 0;                 // N m
  double relative_error = 0;                     // estimated, of the energy norm
  Eigen::VectorXd part_maximum_von_mises;        // parts, Pa
  Eigen::VectorXd part_safety_factor;            // parts; infinite where strength is unknown
  std::vector<Eigen::Vector3d> reactions;        // N, of each support
};

struct HeatOutcome {
  double minimum = 0, maximum = 0;
  double supplied = 0;              // W
  double through_temperatures = 0;  // W
  std::vector<double> convected;    // W, of each convection
};

// Returns the outcome of a load case. `support_nodes` has the nodes of each support.
CaseOutcome OutcomeOf(const std::string& name, const mesh::TetrahedralMesh& mesh,
                      const ElasticitySolution& solution, double relative_error,
                      const StressSpread& spread,
                      const std::vector<std::vector<int>>& support_nodes);

HeatOutcome OutcomeOf(const HeatSolution& solution);

// Whether every number that is told or shown is finite.
bool IsFinite(const StressSpread& spread);
bool IsFinite(const ElasticitySolution& solution);
bool IsFinite(const HeatSolution& solution);

// Returns the nodes of each support, ascending.
std::vector<std::vector<int>> NodesOf(const mesh::TetrahedralMesh& mesh,
                                      const std::vector<Support>& supports);

// Returns the name of a file for a load case: "2-own-weight-1-5" for "Own weight, 1.5×", the
// second, of letters and digits that every file system takes.
std::string FileStem(std::size_t number, const std::string& name);

// Returns a VTU file with displacement, stress tensor, von Mises and largest principal stress,
// reactions, where it is warm the temperature, and the estimated error of each element.
// Temperatures of the solution are above `reference_temperature`.
absl::StatusOr<std::string> WriteFields(const mesh::TetrahedralMesh& mesh,
                                        const ElasticitySolution& solution,
                                        const Eigen::VectorXd& element_error,
                                        double reference_temperature);

// Returns the heat flux in each element, W/m²: 3 × elements, the mean of its integration points.
Eigen::Matrix3Xd ElementHeatFlux(const mesh::TetrahedralMesh& mesh,
                                 const std::vector<Material>& materials,
                                 const Eigen::VectorXd& temperature);

// Returns a VTU file with the temperature at the nodes and the heat flux in each element.
absl::StatusOr<std::string> WriteHeat(const mesh::TetrahedralMesh& mesh,
                                      const std::vector<Material>& materials,
                                      const Eigen::VectorXd& temperature);

}  // namespace mortise::simulator
