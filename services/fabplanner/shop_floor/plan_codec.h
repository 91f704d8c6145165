// Between the structs of the planner and the messages of mortise/v1. Only adapters use it.
#pragma once

#include "absl/status/statusor.h"
#include "mortise/v1/fabplanner.pb.h"
#include "mortise/v1/hwbridge.pb.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"
#include "services/fabplanner/shop_floor/work_order.h"

namespace mortise::fabplanner {

// Returns the rules with defaults where the message says zero; unchecked.
WorkshopRules RulesFrom(const v1::WorkshopRules& message);

// Writes what the plan of the design knows of itself; name, template, parameters, artifacts and
// time are the caller's.
v1::Plan ToProto(const FabricationPlan& plan, const Design& design);

// Reads boards, sheets and rules of a stored plan: all that cutting needs.
FabricationPlan CuttingPlanFrom(const v1::Plan& message);

// Writes a cut as it is stored and shown; `work_order` is its resource name.
v1::WorkOrder::Cut ToProto(const Cut& cut, const std::string& work_order);
Cut CutFrom(const v1::WorkOrder::Cut& message);

v1::WorkOrder::State ToProto(OrderState state);
OrderState OrderStateFrom(v1::WorkOrder::State state);

// INVALID_ARGUMENT naming the field if the outcome is not known.
absl::StatusOr<CutReport> CutReportFrom(const v1::CutReport& message);

}  // namespace mortise::fabplanner
