// Makes the whole fabrication plan of a design: cuts, holes, assembly and bill of materials.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "services/fabplanner/design.h"
#include "services/fabplanner/plan.h"

namespace mortise::fabplanner {

// Most parts one plan may have, over all copies: past it plans outgrow messages and diagrams.
inline constexpr int kMostParts = 10000;

// The label of a part in copy 1, 2, 3 … of `quantity`: its name, and the copy where there are
// several ("leg_1.2").
std::string PartLabel(const std::string& name, int copy, int quantity);

// Whether the rules can be used. INVALID_ARGUMENT naming "rules.kerf" and so on.
absl::Status CheckRules(const WorkshopRules& rules);

// Plans `quantity` copies, 1 to 1000. Boards are cut by item and section, sheets by item and
// thickness. Grain runs along an item's length, so outlines are not turned. Fails as CheckRules,
// CutStock, LayOutSheets, HolesFor, AssemblySteps and MakeBill do; RESOURCE_EXHAUSTED past
// kMostParts.
absl::StatusOr<FabricationPlan> MakePlan(const Design& design, const Items& items, int quantity,
                                         const WorkshopRules& rules = {});

}  // namespace mortise::fabplanner
