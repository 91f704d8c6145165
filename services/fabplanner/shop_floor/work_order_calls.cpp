#include "services/fabplanner/shop_floor/work_order_calls.h"

#include <google/protobuf/util/time_util.h>

#include <functional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/host/operation_codec.h"
#include "common/operations/operation_kinds.h"
#include "common/resources/collection.h"
#include "common/resources/resource_tags.h"
#include "services/fabplanner/shop_floor/order_records.h"
#include "services/fabplanner/shop_floor/plan_codec.h"
#include "services/fabplanner/shop_floor/plan_records.h"

namespace mortise::fabplanner {
namespace {

// What bridge, machine, numbers and messages may add to a cut once it is given out.
constexpr int kGrowthOfACut = 100;  // bytes

google::protobuf::Timestamp ToTimestamp(absl::Time time) {
  return google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(time));
}

absl::StatusOr<v1::WorkOrder> ChangeState(const std::string& name, store::Transaction& transaction,
                                          const std::function<absl::Status(WorkOrder&)>& change) {
  MORTISE_RETURN_IF_ERROR(ParseResourceName(name, "workOrders", "name").status());
  MORTISE_ASSIGN_OR_RETURN(v1::WorkOrder whole, GetWholeOrder(transaction, name));
  std::vector<Cut> cuts;
  for (const v1::WorkOrder::Cut& cut : whole.cuts()) cuts.push_back(CutFrom(cut));
  WorkOrder work(std::move(cuts), OrderStateFrom(whole.state()));
  MORTISE_RETURN_IF_ERROR(change(work));
  if (ToProto(work.state()) == whole.state()) return whole;
  whole.set_state(ToProto(work.state()));
  *whole.mutable_update_time() = ToTimestamp(transaction.Now());
  v1::WorkOrder summary = whole;
  summary.clear_cuts();
  MORTISE_RETURN_IF_ERROR(PutOrder(transaction, summary));
  MORTISE_RETURN_IF_ERROR(AppendOrderEvent(transaction, summary));
  return whole;
}

}  // namespace

absl::StatusOr<operations::Operation> ReleaseOrder(const rpc::Call& call,
                                                   const v1::ReleaseWorkOrderRequest& request,
                                                   operations::Operations& operations,
                                                   store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(
      CombineViolations(ParseResourceName(request.plan(), kPlans.names, "plan").status(),
                        resources::ValidateTags(request)));
  MORTISE_ASSIGN_OR_RETURN(const v1::Plan plan, kPlans.Get(transaction, request.plan(), "plan"));
  const std::vector<Cut> cuts = CutsFor(CuttingPlanFrom(plan));
  if (cuts.empty()) {
    return PreconditionFailed("NOTHING_TO_CUT",
                              absl::StrCat(request.plan(), " has no parts that machines cut"),
                              request.plan());
  }
  v1::WorkOrder order;
  order.set_name(absl::StrCat("workOrders/", NewIdentifier()));
  order.set_plan(request.plan());
  order.set_state(v1::WorkOrder::RELEASED);
  order.set_cuts_total(static_cast<int>(cuts.size()));
  *order.mutable_handwork() = plan.handwork();
  resources::CopyTags(request, &order);
  order.set_creator(call.identity().subject);
  *order.mutable_create_time() = ToTimestamp(transaction.Now());
  *order.mutable_update_time() = order.create_time();
  std::size_t bytes = order.ByteSizeLong();
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    bytes += ToProto(cuts[i], order.name()).ByteSizeLong() + kGrowthOfACut;
    MORTISE_RETURN_IF_ERROR(PutCut(transaction, order.name(), static_cast<int>(i), cuts[i]));
  }
  if (bytes > kMaxMessageBytes) {
    return TooLarge(absl::StrCat("a work order of ", cuts.size(), " cuts"),
                    absl::StrCat(kMaxMessageBytes, " bytes; plan fewer copies at a time"));
  }
  MORTISE_ASSIGN_OR_RETURN(
      operations::Operation operation,
      operations.Start(transaction, rpc::OperationOf(call, operations::kWorkOrderOperation,
                                                     order.name(), request, order.name())));
  order.set_operation(operation.name);
  MORTISE_RETURN_IF_ERROR(PutOrder(transaction, order));
  MORTISE_RETURN_IF_ERROR(AppendOrderEvent(transaction, order));
  return operation;
}

absl::StatusOr<v1::WorkOrder> HoldOrder(const std::string& name, store::Transaction& transaction) {
  return ChangeState(name, transaction, [&](WorkOrder& work) { return work.Hold(name); });
}

absl::StatusOr<v1::WorkOrder> ResumeOrder(const std::string& name,
                                          store::Transaction& transaction) {
  return ChangeState(name, transaction, [&](WorkOrder& work) { return work.Resume(name); });
}

absl::Status CancelOrder(const std::string& name, store::Transaction& transaction) {
  return ChangeState(name, transaction,
                     [&](WorkOrder& work) {
                       return IsFinal(work.state()) ? absl::OkStatus() : work.Cancel(name);
                     })
      .status();
}

absl::StatusOr<std::string> RunWorkOrder(operations::OperationContext& context,
                                         operations::Operations& operations, store::Store& store,
                                         ShopFloor& floor) {
  const std::string name = context.request();
  // Whatever else goes wrong here, a bridge that attaches makes good; the order goes on.
  if (const absl::Status status = floor.Refresh(name); absl::IsNotFound(status)) return status;
  ShopFloor::Standing standing;
  while (true) {
    const ShopFloor::Standing before = standing;
    MORTISE_ASSIGN_OR_RETURN(standing, floor.WaitForChange(name, before, absl::Milliseconds(200)));
    // An order may wait for machines for days; that is no news to store and to tell.
    if (standing.state != before.state || standing.done != before.done || before.total == 0 ||
        standing.held != before.held) {
      context.ReportProgress(
          {.done = standing.done,
           .total = standing.total,
           .message = absl::StrCat("the order is ", OrderStateName(standing.state),
                                   standing.held.empty() ? "" : "; ", standing.held)});
    }
    if (IsFinal(standing.state)) break;
    if (!context.Cancelled()) continue;
    MORTISE_ASSIGN_OR_RETURN(const operations::Operation operation, operations.Get(context.name()));
    if (operation.cancel_requested) MORTISE_RETURN_IF_ERROR(floor.Cancel(name));
    return absl::CancelledError("the work order was cancelled");
  }
  floor.Forget(name);
  if (standing.state == OrderState::kCancelled) {
    return absl::CancelledError("the work order was cancelled");
  }
  if (standing.state == OrderState::kFailed) {
    return PreconditionFailed("CUT_FAILED", standing.trouble, name);
  }
  MORTISE_ASSIGN_OR_RETURN(
      const v1::WorkOrder order,
      resources::ReadFrom<v1::WorkOrder>(store, [&](store::ReadTransaction& transaction) {
        return GetWholeOrder(transaction, name);
      }));
  return rpc::PackResult(order);
}

}  // namespace mortise::fabplanner
