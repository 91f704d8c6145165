// How families are covered for an index (thesis §4.3, §4.4).
#pragma once

#include "common/templates/template.h"
#include "services/retrieval/cover/manifold_cover.h"
#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::retrieval {

// Returns the δ that an index has if nobody says another: a quarter of how far apart unlike shapes
// are by the descriptor, which tells kinds of furniture apart in minutes.
double DefaultDelta(const Descriptor& descriptor);

// Covers one family on one thread, always in the same way, and gives up on families that would take
// more than their share of an index, of which those whose designs are meshed anew have fewer
// evaluations, as each takes a quarter of a second: the cover's `end` says so.
CoverOptions FamilyCoverOptions(double delta, const templates::Template& function);

}  // namespace mortise::retrieval
