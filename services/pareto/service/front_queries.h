// Questions of clients about a front (front_exploration.h), by the names they know.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/front/front_exploration.h"

namespace mortise::pareto {

// A front as it is stored, and ready to be explored.
struct OpenFront {
  explicit OpenFront(v1::Front stored);

  v1::Front message;
  FrontExploration exploration;
};

// INVALID_ARGUMENT naming the field at fault ("metric.unit", "index", "steps", ...);
// FAILED_PRECONDITION, FRONT_EMPTY, when the front has no points.
absl::StatusOr<v1::PickPointResponse> Pick(const OpenFront& front,
                                           const v1::PickPointRequest& request);

// INVALID_ARGUMENT naming the field at fault ("limits[0].name", ...).
absl::StatusOr<v1::RestrictFrontResponse> Restrict(const OpenFront& front,
                                                   const v1::RestrictFrontRequest& request);

}  // namespace mortise::pareto
