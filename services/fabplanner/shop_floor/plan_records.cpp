#include "services/fabplanner/shop_floor/plan_records.h"

#include <string>

#include "common/base/errors.h"
#include "common/base/identifiers.h"

namespace mortise::fabplanner {
namespace {

v1::Plan SummaryOf(v1::Plan plan) {
  plan.clear_boards();
  plan.clear_sheets();
  plan.clear_steps();
  plan.clear_bill();
  plan.clear_bill_tree();
  plan.clear_holes();
  plan.clear_parts();
  plan.clear_marks();
  plan.clear_handwork();
  plan.clear_artifacts();
  return plan;
}

absl::Status PutSummary(store::Transaction& transaction, const std::string& id,
                        const v1::Plan& plan) {
  return transaction.Put(kPlanSummaries.kind, id, SummaryOf(plan).SerializeAsString()).status();
}

}  // namespace

absl::Status CreatePlanRecords(store::Transaction& transaction, const v1::Plan& plan) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id,
                           ParseResourceName(plan.name(), kPlans.names, "name"));
  MORTISE_RETURN_IF_ERROR(
      transaction.Put(kPlans.kind, id, plan.SerializeAsString(), {.expected_revision = 0})
          .status());
  return PutSummary(transaction, id, plan);
}

absl::StatusOr<v1::Plan> UpdatePlanTags(store::Transaction& transaction,
                                        const v1::UpdatePlanRequest& request,
                                        const resources::Author& author) {
  MORTISE_ASSIGN_OR_RETURN(v1::Plan plan, kPlans.UpdateTags(transaction, request.plan(),
                                                            request.update_mask(), "plan", author));
  MORTISE_ASSIGN_OR_RETURN(const std::string id,
                           ParseResourceName(plan.name(), kPlans.names, "plan.name"));
  MORTISE_RETURN_IF_ERROR(PutSummary(transaction, id, plan));
  return plan;
}

}  // namespace mortise::fabplanner
