// Compares a map with its evaluator, as a long-running operation.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"
#include "common/operations/operations.h"
#include "services/interpolator/records/loaded_shapes.h"
#include "services/interpolator/service/loaded_maps.h"

namespace mortise::interpolator {

inline constexpr int kMaxVerified = 1000;  // designs, as many as one call of an evaluator takes
inline constexpr int kDefaultVerified = 10;

// Runs the operation whose request is a VerifyMapRequest. Writes how far the map was off into it,
// and the event `map.updated`; returns the map. A run that begins again evaluates again, which the
// simulator answers from what it keeps.
absl::StatusOr<std::string> RunVerifyOperation(rpc::ServiceEnvironment& environment,
                                               LoadedMaps& loaded, LoadedShapes& shapes,
                                               operations::OperationContext& context);

}  // namespace mortise::interpolator
