// Finds the parts that patterns of a design might lose: a screw in one board of a row is held by
// the row's box alone, and would stand in a gap when the boards are spread anew.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/pattern.h"
#include "common/assembly/relations/feasible_set.h"

namespace mortise::parametric {

// Returns pairs of a pattern's part and a part that it might lose. Such a part
// - stands between those of the pattern without touching one, or touches the pattern in part only
//   (pattern_contact.h),
// - does not repeat together with it, and
// - in some feasible design neither lies on its first or its last part nor bridges its gaps.
//
// Where two patterns repeat together for a while and one goes on, that one is to end where the
// other does: what it touches beyond is what it might lose. This is decided by six linear
// programmes for each such contact. Fails as FeasibleSet::RangesOf does.
absl::StatusOr<PatternLosses> FindPatternLosses(const Assembly& assembly,
                                                const std::vector<Element>& elements,
                                                const FeasibleSet& feasible_set, double tolerance);

}  // namespace mortise::parametric
