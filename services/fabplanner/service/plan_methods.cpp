#include "services/fabplanner/service/plan_methods.h"

#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/host/call_author.h"
#include "common/host/chunk_stream.h"
#include "common/host/operation_codec.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/resources/collection.h"
#include "common/rpc/channel.h"
#include "services/fabplanner/service/plan_operation.h"
#include "services/fabplanner/shop_floor/plan_records.h"

namespace mortise::fabplanner::methods {

absl::StatusOr<CheckedPlan> CheckPlan(const FabPlanner& planner, const rpc::Call& call,
                                      const v1::CreatePlanRequest& asked) {
  const absl::Status checked = CheckRequest(asked);
  // What is wrong with the parameters is told with the rest, where a template is named.
  const bool names_template = CheckTemplate(asked).ok();
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      checked, names_template ? planner.planning->CheckDesign(asked, rpc::ForwardedFrom(call))
                              : absl::OkStatus()));
  return CheckedPlan();
}

absl::StatusOr<v1::Operation> CreatePlan(const FabPlanner& planner, const rpc::Call& call,
                                         const v1::CreatePlanRequest& asked, const CheckedPlan&,
                                         store::Transaction& transaction) {
  MORTISE_ASSIGN_OR_RETURN(
      const operations::Operation operation,
      planner.operations->Start(transaction, rpc::OperationOf(call, operations::kPlanOperation,
                                                              asked.template_(), asked)));
  return rpc::ToProto(operation);
}

absl::StatusOr<v1::Plan> GetPlan(const FabPlanner& planner, const rpc::Call&,
                                 const v1::GetPlanRequest& asked) {
  return kPlans.Get(*planner.store, asked.name());
}

absl::StatusOr<v1::ListPlansResponse> ListPlans(const FabPlanner& planner, const rpc::Call&,
                                                const v1::ListPlansRequest& asked) {
  const absl::Status subject =
      asked.subject().empty() ? absl::OkStatus()
                              : ParseResourceName(asked.subject(), "templates", "subject").status();
  MORTISE_RETURN_IF_ERROR(CombineViolations(resources::CheckListRequest(asked), subject));
  MORTISE_ASSIGN_OR_RETURN(resources::Page<v1::Plan> page,
                           kPlanSummaries.List(*planner.store, asked, [&](const v1::Plan& plan) {
                             return asked.subject().empty() || plan.template_() == asked.subject();
                           }));
  return resources::ToResponse(std::move(page), &v1::ListPlansResponse::mutable_plans);
}

absl::StatusOr<v1::Plan> UpdatePlan(const FabPlanner&, const rpc::Call& call,
                                    const v1::UpdatePlanRequest& asked,
                                    store::Transaction& transaction) {
  return UpdatePlanTags(transaction, asked, rpc::AuthorOf(call));
}

absl::Status DownloadArtifact(const FabPlanner& planner, const rpc::Call&,
                              const v1::DownloadArtifactRequest& asked,
                              const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
  MORTISE_ASSIGN_OR_RETURN(const v1::Plan plan, kPlans.Get(*planner.store, asked.name()));
  return rpc::StreamArtifact(planner.blobs, asked.name(), plan.artifacts(), asked.file_name(),
                             writer);
}

}  // namespace mortise::fabplanner::methods
