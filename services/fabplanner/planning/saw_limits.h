// Finds which ends of a part the chop saw cuts as they are. Private to this folder.
#pragma once

#include <vector>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/end_cuts.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns how the saw cuts the part's ends: as `ends`, which are the part's own, but square where
// the rules forbid it, of which it adds a limit each. What is sawn contains the part.
//
// The board lies flat. Stock of square section is turned by a quarter where that makes mitres of
// bevels, or brings all ends within the limits; the result is as it lies then.
CutEnds SawnEnds(const Part& part, const CutEnds& ends, const WorkshopRules& rules,
                 std::vector<MachineLimit>* limits);

}  // namespace mortise::fabplanner
