// Finds the nearest parameters by which machines make what they cannot make of a design.
//
// A small search along one parameter at a time, with all others as they are: nine points over its
// range, then, from the nearest at which the part is made towards the design's value, halves of the
// way in steps of the parameter. So the value is the nearest where the limit is passed once between
// the two; where it is passed back and forth, it is one that does.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// A parameter of a template.
struct DesignParameter {
  std::string name;
  std::string unit;  // SI; "1" where dimensionless
  double minimum = 0;
  double maximum = 0;
  double step = 0;                        // 0 for none
  double value = 0;                       // of the design
  std::vector<std::string> choices = {};  // of one that is a choice, the names of its values
};

// Returns how the parts are come by where the parameter of the index has a value and all others are
// as in the design; nothing where there is no such design. It fails where designs cannot be looked
// at any more.
using PartsAt = std::function<absl::StatusOr<std::optional<std::vector<PlannedPart>>>(
    std::size_t parameter, double value)>;

// The most designs that one search looks at.
inline constexpr int kMostDesigns = 400;

// Adds to each limit of `plan`'s parts the nearest values at which the part has none of its kind,
// and none of a kind that it has not as it is; says so in its reason, and in the plan's handwork.
// For sharp inner corners only parameters are looked along by which they go at an end of the range.
// Fails as `parts_at`; the plan has then what was found before.
absl::Status AddNearestParameters(const std::vector<DesignParameter>& parameters,
                                  const PartsAt& parts_at, FabricationPlan* plan);

}  // namespace mortise::fabplanner
