// Fits the design that a component comes from to the component as it is now, so that what stood
// around it there can be compared with what stands around it in the model (thesis §5.6.1).
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "services/composer/model/placed_forms.h"

namespace mortise::composer {

// Returns the principal parts of `original` when the parts that it shares with the component, by
// name, are as nearly as it allows where the component has them, and the rest is as little changed
// as that allows: the minimum of ‖S q^D − q^A‖ over its feasible set, free in space. What a row of
// the original leaves open, as where the third shelf of six stands, follows by moving all of it
// along. Fails as FeasibleSet::Nearest.
absl::StatusOr<std::vector<PrincipalPart>> FitOriginal(const Design& original,
                                                       const Design& component);

}  // namespace mortise::composer
