// Makes the holes for pegs: each peg needs one in both parts that it joins.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// The depth by which a hole is deeper than its peg reaches, so that glue and shavings have room, m.
inline constexpr double kHoleClearance = 0.001;

// Returns two holes a peg, in the order of the pegs: first that in `part`, then that in
// `other_part`. INVALID_ARGUMENT naming the peg's connection for unusable numbers or unknown parts;
// FAILED_PRECONDITION, reason PEG_TOO_LONG, naming part and depths, where a hole would come out at
// the far side of the part's bounding box.
absl::StatusOr<std::vector<Hole>> HolesFor(const Design& design);

// Returns how many pegs of each item the design needs.
std::map<std::string, int> CountPegs(const Design& design);

}  // namespace mortise::fabplanner
