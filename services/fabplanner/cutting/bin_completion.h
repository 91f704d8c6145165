// Exact bin packing by bin completion, within a number of steps. Internal to bin_packing.
#pragma once

#include <cstdint>

#include "services/fabplanner/cutting/packing_problem.h"

namespace mortise::fabplanner {

// Branches over the ways to complete the bin of the largest item left, fullest first (Martello and
// Toth 1990, Korf 2002). Improves `best`, a solution, and returns true if it is then proven to be
// the cheapest: it meets `lower_bound`, or the search ended within `steps`.
bool CompleteBins(const PackingProblem& problem, int64_t lower_bound, int64_t steps,
                  Solution* best);

}  // namespace mortise::fabplanner
