// Makes the whole fabrication plan of a design: cuts, holes, assembly and bill of materials.
#pragma once

#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "services/fabplanner/cutting/stock_cutting.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// The most parts that one plan may have, over all copies: past it plans outgrow messages and
// diagrams.
inline constexpr int kMaxParts = 10000;

// Whether the rules can be used. INVALID_ARGUMENT naming "rules.kerf" and so on.
absl::Status CheckRules(const WorkshopRules& rules);

// Plans `quantity` copies, 1 to 1000: what is cut, bought and made to drawing, the holes, the steps
// and the bill. Fails as CheckRules, PlanParts, CutParts, HolesFor, AddFastenerHoles, AssemblySteps
// and MakeBill do; RESOURCE_EXHAUSTED past kMaxParts; CANCELLED once a stop is requested.
absl::StatusOr<FabricationPlan> MakePlan(const Design& design, const Items& items, int quantity,
                                         const WorkshopRules& rules = {},
                                         const std::stop_token& stop = {});

}  // namespace mortise::fabplanner
