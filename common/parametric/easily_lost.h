// Which parts the patterns of a design might lose: a screw in one board of a row is held by the
// row's box alone, and would stand in a gap when the boards are spread anew.
#pragma once

#include <set>
#include <vector>

#include "absl/status/statusor.h"
#include "common/parametric/assembly.h"
#include "common/parametric/element.h"
#include "common/parametric/feasible_set.h"

namespace mortise::parametric {

// Indices of parts that stand between those of a pattern without touching one, and of those that
// touch a pattern in part only (pattern_contact.h), do not repeat together with it, and in some
// feasible design neither lie on its first or its last part nor bridge its gaps. Decided by linear
// programmes: six for each such contact. Fails as FeasibleSet::RangesOf.
absl::StatusOr<std::set<int>> FindEasilyLost(const Assembly& assembly,
                                             const std::vector<Element>& elements,
                                             const FeasibleSet& feasible_set, double tolerance);

}  // namespace mortise::parametric
