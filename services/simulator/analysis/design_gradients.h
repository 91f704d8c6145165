// Computes exact gradients of what is computed of a design under its loads, with respect to its
// parameters.
//
// With K(X) u = f(X, q) on a mesh whose nodes move as X(q), the gradient of J(u, X) is
//   dJ/dq = ∂J/∂X·V + λᵀ (∂f/∂q + ∂f/∂X·V − (∂K/∂X·V) u),   K λ = ∂J/∂u,
// the adjoint method: one more solution over the factor of K for each J, whatever the number of
// parameters; of the compliance λ = u. It is the derivative of the discrete J on the mesh that
// moves along, to rounding. What a new mesh would give differs by the error of the discretisation.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/expressions/metric_function.h"
#include "common/fem/elements/mesh_velocity.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

// A face of a prism and how it changes with the parameters.
struct FaceShapeMotion {
  mesh::NamedFace face;
  Eigen::Vector3d centroid;        // m
  Eigen::VectorXd area_rate;       // parameters, m² per unit of each
  Eigen::Matrix3Xd centroid_rate;  // 3 × parameters
};

// Says how a model changes with the parameters of its design.
struct DesignMotion {
  std::vector<FaceMotion> faces;
  std::vector<FaceShapeMotion> shapes;  // of the same faces
  // The rates of change of the loads' forces, pressures and gravity with each parameter.
  std::vector<DesignModel> load_rates;
  Eigen::VectorXd mass, volume;  // kg and m³, per unit of each parameter
};

// Whether the gradient of a call is known under loads: it is of displacements of faces and points,
// mean or largest, in all or along an axis, and of the integral and the mean square of the stress
// in parts.
bool HasGradientUnderLoads(const parametric::MetricCall& call);

// Returns the gradient of an area, a centroid or a distance of faces and points; nothing where a
// place is not known, or two that are as far apart as 0.
std::optional<Eigen::VectorXd> GradientOfShape(const parametric::MetricCall& call,
                                               const DesignModel& model, const DesignMotion& motion,
                                               const parametric::MetricExpressions& own,
                                               const Eigen::VectorXd& parameters);

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
  const parametric::MetricExpressions& own;  // whose points calls may name
  const Eigen::VectorXd& parameters;
  double memory_limit = 8e9;  // bytes
  int threads = 1;
};

// Returns the gradients of those metrics under loads and calls that have one, by metric or by
// ToText of the call: of the load case where each is largest (of a call: in magnitude), or the one
// that it names. What is largest somewhere is differentiated at the node where it is. Fails as
// NodeVelocities does and as the system solves.
absl::StatusOr<std::map<std::string, Eigen::VectorXd>> GradientsUnderLoads(
    const SolvedLoads& solved, const DesignMotion& motion, const std::vector<std::string>& metrics,
    const std::vector<parametric::MetricCall>& calls);

}  // namespace mortise::simulator
