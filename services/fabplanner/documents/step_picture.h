// Draws the picture of a step in which parts come in along ways of their own, and screws after
// them: what stands in grey, what comes in in colour and away from its place, with arrows; screws
// before their holes, hinges and the like half-way to theirs.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns the PNG of the step. Only what the step says to stand or to come in is drawn.
absl::StatusOr<std::string> OrderedStepPicture(const Design& design, const Items& items,
                                               const std::vector<Hole>& holes,
                                               const AssemblyStep& step);

}  // namespace mortise::fabplanner
