// Chooses which boards and sheets a design is cut from, and says what of them must be bought.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "services/fabplanner/plan/bill_of_materials.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns the label of a part in copy 1, 2, 3 … of `quantity`: its name, and the copy where there
// are several ("leg_1.2").
std::string PartLabel(const std::string& name, int copy, int quantity);

// Lays out every part that a machine cuts (`plan->parts` says which), in `plan->quantity` copies:
// boards by item and section from all lengths the item is sold in, for the least price where that
// of every length is known, else for the least length; sheets by item and thickness, each as small
// a size as holds what is on it for the least price. Adds boards, sheets, counts and handwork to
// the plan, and what is bought for them to `purchases`. Grain runs along an item's length, so
// outlines are turned only on items that have none.
//
// A board that is ripped to its parts' widths is bought in full width, and gives as many strips as
// fit, of whatever widths; the saw gets the strips. Fails as CutStock and LayOutSheets do, naming
// part and item.
absl::Status CutParts(const Design& design, const Items& items, FabricationPlan* plan,
                      std::vector<Purchase>* purchases);

}  // namespace mortise::fabplanner
