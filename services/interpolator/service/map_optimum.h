// The best design of a map, by the names that clients know.
#pragma once

#include <functional>

#include "absl/status/statusor.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/service/loaded_maps.h"

namespace mortise::interpolator {

// Optimises over all structures of the map that keep to what is `fixed`, and returns the best
// design of any. INVALID_ARGUMENT naming the fields at fault: "objective", "limits[0].metric",
// "fixed[1].value", "starts"; FAILED_PRECONDITION, MAP_UNCOVERED, where the map has no values at
// any start; CANCELLED soon after `is_given_up` says so. Takes some milliseconds for each start and
// structure.
absl::StatusOr<v1::OptimizeMapResponse> FindOptimum(const LoadedMap& map,
                                                    const v1::OptimizeMapRequest& asked,
                                                    const std::function<bool()>& is_given_up);

}  // namespace mortise::interpolator
