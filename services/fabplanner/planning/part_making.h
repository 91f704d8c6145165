// Finds how each part of a design is come by: cut by a machine, bought, or made to a drawing.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// The amount by which a part may differ from a size that its item fixes, m: a rule cannot tell it.
inline constexpr double kSizeTolerance = 5e-5;

// Returns one entry a part, in order:
// - what its item's process cuts is crosscut or cut to outline. Ends of lumber are cut square,
//   mitred and bevelled as far as the rules say that the chop saw can. If the part is not what such
//   cuts give (a turned leg, a slotted panel, an end past the saw's angles) they give its blank,
//   and what is left is handwork after a drawing; where a rule is at fault it says so.
//   Outlines are cut as they are, and inner corners and arcs that are tighter than the jigsaw's
//   radius are told of;
// - what is of an item that nothing resizes is bought;
// - what is of no item is made to a drawing.
// INVALID_ARGUMENT naming parts without usable numbers, or of unknown items; FAILED_PRECONDITION,
// reason PART_NOT_IN_STOCK, naming part, item and sizes, where the item is not sold in the part's
// section or thickness, or cannot be cut that short.
absl::StatusOr<std::vector<PlannedPart>> PlanParts(const Design& design, const Items& items,
                                                   const WorkshopRules& rules = {});

}  // namespace mortise::fabplanner
