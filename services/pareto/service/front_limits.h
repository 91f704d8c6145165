// Limits that a client asks of a front's metrics and parameters, and what is to be said of them.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/front/front_exploration.h"

namespace mortise::pareto {

// The limits of a request as they are kept to, in its order, and remarks for people.
//
// A single value, as minimum and maximum both, is met by points by chance only. If two or more have
// it to the last bit, as of whole numbers and choices, it is kept to as it is. Else it becomes a
// band about it, a hundredth of what the front reaches of that metric or parameter wide, with a
// remark that says so.
struct FrontLimits {
  std::vector<FrontLimit> limits;
  std::vector<std::string> remarks;
};

// INVALID_ARGUMENT naming the field at fault ("limits[0].name", ...).
absl::StatusOr<FrontLimits> ReadLimits(const v1::Front& front, const FrontExploration& exploration,
                                       const v1::RestrictFrontRequest& request);

// Why no point meets the limits: for each that none meets by itself the nearest value there is,
// printed so that it differs from the limit; else that they do not go together.
std::vector<std::string> WhyNothingRemains(const v1::Front& front,
                                           const FrontExploration& exploration,
                                           const std::vector<FrontLimit>& limits);

}  // namespace mortise::pareto
