// From a template at given parameters to the model that is analysed.
#pragma once

#include "absl/status/statusor.h"
#include "common/parametric/evaluation.h"
#include "services/simulator/design_analysis.h"

namespace mortise::simulator {

// Fuses the parts of `design`, looks up what they are made of, and turns its boundary conditions
// into supports and loads. Fails as cad::FuseAssembly does; INVALID_ARGUMENT naming the template's
// field where an item, material or part is missing.
absl::StatusOr<DesignModel> MakeDesignModel(const parametric::TemplateBundle& bundle,
                                            const parametric::EvaluatedDesign& design);

// The gradient of a metric with respect to all parameters.
struct MetricGradient {
  std::string metric;
  Eigen::VectorXd values;  // metric unit per parameter unit
};

// Exact gradients of those of `metrics` that offer them: mass and volume.
absl::StatusOr<std::vector<MetricGradient>> MetricGradients(
    const parametric::TemplateFunction& function, const Eigen::VectorXd& parameters,
    const std::vector<std::string>& metrics);

// Whether MetricGradients gives the gradient of this metric.
bool OffersGradient(const std::string& metric);

}  // namespace mortise::simulator
