// The displacement of a face or a point and its derivatives, of which gradients of metrics are
// made. Private to this folder.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "common/expressions/metric_function.h"
#include "services/simulator/analysis/design_gradients.h"

namespace mortise::simulator {

// A displacement of a place, and its derivatives.
struct PlaceDisplacement {
  double value = 0;                             // m
  Eigen::Matrix3Xd by_field, by_position = {};  // 3 × nodes
  Eigen::VectorXd by_parameters = {};           // as a point moves with them; empty of a face
};

// Returns what a call of mean_displacement or max_displacement is in one of the load cases.
// INVALID_ARGUMENT for a face that is none and a point outside of the body.
absl::StatusOr<PlaceDisplacement> DisplacementOf(const parametric::MetricCall& call,
                                                 const SolvedLoads& solved, const SolvedCase& of);

}  // namespace mortise::simulator
