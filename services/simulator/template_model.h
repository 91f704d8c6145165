// From a template at given parameters to the model that is analysed.
#pragma once

#include "absl/status/statusor.h"
#include "common/templates/template.h"
#include "services/simulator/design_analysis.h"

namespace mortise::simulator {

// Fuses the parts of `design`, looks up what they are made of, and turns its boundary conditions
// into supports and loads. What only connects parts is left out: they are bonded where they touch.
// Heat has no part in elasticity. Fails as cad::FuseAssembly does; INVALID_ARGUMENT naming the
// design's field where a material or part is missing; UNIMPLEMENTED for several parts of which one
// is no prism.
absl::StatusOr<DesignModel> MakeDesignModel(const std::vector<parametric::Material>& materials,
                                            const parametric::EvaluatedDesign& design);

// The gradient of a metric with respect to all parameters.
struct MetricGradient {
  std::string metric;
  Eigen::VectorXd values;  // metric unit per parameter unit
};

// Exact gradients of those of `metrics` that offer them: mass and volume, of some templates.
absl::StatusOr<std::vector<MetricGradient>> MetricGradients(
    const templates::Template& function, const Eigen::VectorXd& parameters,
    const std::vector<std::string>& metrics);

// Whether MetricGradients gives the gradient of this metric.
bool OffersGradient(const templates::Template& function, const std::string& metric);

}  // namespace mortise::simulator
