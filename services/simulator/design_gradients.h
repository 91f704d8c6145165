// Exact gradients of what is computed of a design under its loads, with respect to its parameters.
//
// With K(X) u = f(X, q) on a mesh whose nodes move as X(q), the gradient of J(u, X) is
//   dJ/dq = ∂J/∂X·V + λᵀ (∂f/∂q + ∂f/∂X·V − (∂K/∂X·V) u),   K λ = ∂J/∂u,
// the adjoint method: one more solution over the factor of K for each J, whatever the number of
// parameters; of the compliance λ = u. It is the derivative of the discrete J on the mesh that
// moves along, to rounding. What a new mesh would give differs by the error of the discretisation.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/parametric/metric_function.h"
#include "services/simulator/design_analysis.h"
#include "services/simulator/mesh_velocity.h"

namespace mortise::simulator {

// How a model changes with the parameters of its design.
struct DesignMotion {
  std::vector<FaceMotion> faces;
  // For each parameter, the loads' forces, pressures and gravity as their rates of change.
  std::vector<DesignModel> load_rates;
  Eigen::VectorXd mass, volume;  // kg and m³, per unit of each parameter
};

// Whether gradients under loads are known of this metric: compliance, strain_energy and
// max_displacement; the last is that of the node where it is largest.
bool HasGradientUnderLoads(const std::string& metric);

// Likewise of mean_displacement_x, _y and _z of a face.
bool HasGradientUnderLoads(const parametric::MetricCall& call);

// Whether a model's supports and loads are of kinds whose changes are known: it is not warm, does
// not turn, and its supports stay where they are.
bool AllowsGradients(const DesignModel& model, const DesignMotion& motion);

// What GradientsUnderLoads works on; all must outlive it.
struct SolvedLoads {
  const mesh::TetrahedralMesh& mesh;
  const DesignModel& model;
  const std::vector<NamedLoadCase>& load_cases;
  const std::vector<SolvedCase>& cases;
  ElasticSystem& system;
  double memory_limit = 8e9;  // bytes
};

// The gradients of those metrics and calls that have one, by metric or by ToText of the call: of
// the load case where each is largest (of a call: in magnitude), or the one that it names. Fails as
// NodeVelocities does and as the system solves.
absl::StatusOr<std::map<std::string, Eigen::VectorXd>> GradientsUnderLoads(
    const SolvedLoads& solved, const DesignMotion& motion, const std::vector<std::string>& metrics,
    const std::vector<parametric::MetricCall>& calls);

}  // namespace mortise::simulator
