#include "services/fabplanner/service/work_order_methods.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/base/violation_lists.h"
#include "common/host/call_author.h"
#include "common/host/operation_codec.h"
#include "common/resources/collection.h"
#include "common/rpc/dispatcher.h"
#include "services/fabplanner/shop_floor/order_records.h"
#include "services/fabplanner/shop_floor/plan_records.h"
#include "services/fabplanner/shop_floor/shop_floor.h"
#include "services/fabplanner/shop_floor/work_order_calls.h"

namespace mortise::fabplanner::methods {
namespace {

using Tell = absl::Status (ShopFloor::*)(const std::string&);

// Tells the shop floor, on another thread: this one may still hold the store.
void TellAfterCommit(const FabPlanner& planner, Tell tell, const std::string& order_name,
                     store::Transaction& transaction) {
  transaction.AfterCommit(
      [floor = planner.floor, dispatcher = planner.dispatcher, tell, order_name] {
        dispatcher->Submit(
            [floor, tell, order_name] {
              const absl::Status status = (floor->*tell)(order_name);
              if (status.ok()) return;
              Log(LogLevel::kWarning, "work order not taken up",
                  {{"work_order", order_name}, {"error", status.message()}});
            },
            rpc::Lane::kUrgent);
      });
}

// The same for an alarm; the answer has its machine alone.
v1::WorkOrder ClearAlarm(const FabPlanner& planner, const v1::HeldMachine& alarm,
                         store::Transaction& transaction) {
  transaction.AfterCommit([floor = planner.floor, dispatcher = planner.dispatcher, alarm] {
    dispatcher->Submit(
        [floor, alarm] { floor->ClearAlarm(alarm.bridge(), alarm.machine().name()); },
        rpc::Lane::kUrgent);
  });
  v1::WorkOrder answer;
  *answer.add_held_machines() = alarm;
  return answer;
}

// INVALID_ARGUMENT naming the field of a list's request that no order can meet.
absl::Status CheckSubjectAndStates(const v1::ListWorkOrdersRequest& asked) {
  std::vector<FieldViolation> violations;
  const int states_there_are = v1::WorkOrder::State_ARRAYSIZE - 1;  // but the unspecified one
  if (asked.states_size() > states_there_are) {
    violations.push_back(
        {"states", absl::StrCat("has ", asked.states_size(), " entries; there are ",
                                states_there_are, " states")});
  }
  for (int i = 0; i < std::min(asked.states_size(), states_there_are); ++i) {
    if (asked.states(i) != v1::WorkOrder::STATE_UNSPECIFIED) continue;
    violations.push_back({absl::StrCat("states[", i, "]"), "must be a state of work orders"});
  }
  const absl::Status states = violations.empty() ? absl::OkStatus() : InvalidFields(violations);
  if (asked.subject().empty()) return states;
  return CombineViolations(ParseResourceName(asked.subject(), kPlans.names, "subject").status(),
                           states);
}

bool Matches(const v1::ListWorkOrdersRequest& asked, const v1::WorkOrder& order) {
  const auto& states = asked.states();
  return (asked.subject().empty() || order.plan() == asked.subject()) &&
         (states.empty() || std::find(states.begin(), states.end(), order.state()) != states.end());
}

}  // namespace

void RefreshAfterCommit(const FabPlanner& planner, const std::string& order_name,
                        store::Transaction& transaction) {
  TellAfterCommit(planner, &ShopFloor::Refresh, order_name, transaction);
}

absl::StatusOr<v1::Operation> ReleaseWorkOrder(const FabPlanner& planner, const rpc::Call& call,
                                               const v1::ReleaseWorkOrderRequest& asked,
                                               store::Transaction& transaction) {
  if (planner.floor->OrdersUnderWay() >= planner.most_orders) {
    return TooLarge("another work order",
                    absl::StrCat(planner.most_orders, " under way at a time"));
  }
  MORTISE_ASSIGN_OR_RETURN(const operations::Operation operation,
                           ReleaseOrder(call, asked, *planner.operations, transaction));
  RefreshAfterCommit(planner, operation.subject, transaction);
  return rpc::ToProto(operation);
}

absl::StatusOr<v1::WorkOrder> GetWorkOrder(const FabPlanner& planner, const rpc::Call&,
                                           const v1::GetWorkOrderRequest& asked) {
  MORTISE_RETURN_IF_ERROR(ParseResourceName(asked.name(), kOrders.names, "name").status());
  MORTISE_ASSIGN_OR_RETURN(
      v1::WorkOrder order,
      resources::ReadFrom<v1::WorkOrder>(*planner.store, [&](store::ReadTransaction& transaction) {
        return GetWholeOrder(transaction, asked.name());
      }));
  for (v1::HeldMachine& held : planner.floor->HeldMachines(asked.name())) {
    *order.add_held_machines() = std::move(held);
  }
  return order;
}

absl::StatusOr<v1::ListWorkOrdersResponse> ListWorkOrders(const FabPlanner& planner,
                                                          const rpc::Call&,
                                                          const v1::ListWorkOrdersRequest& asked) {
  MORTISE_RETURN_IF_ERROR(
      CombineViolations(resources::CheckListRequest(asked), CheckSubjectAndStates(asked)));
  MORTISE_ASSIGN_OR_RETURN(resources::Page<v1::WorkOrder> page,
                           kOrders.List(*planner.store, asked, [&](const v1::WorkOrder& order) {
                             return Matches(asked, order);
                           }));
  return resources::ToResponse(std::move(page), &v1::ListWorkOrdersResponse::mutable_work_orders);
}

absl::StatusOr<v1::WorkOrder> UpdateWorkOrder(const FabPlanner&, const rpc::Call& call,
                                              const v1::UpdateWorkOrderRequest& asked,
                                              store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(kOrders
                              .UpdateTags(transaction, asked.work_order(), asked.update_mask(),
                                          "work_order", rpc::AuthorOf(call))
                              .status());
  return GetWholeOrder(transaction, asked.work_order().name());
}

absl::StatusOr<v1::WorkOrder> HoldWorkOrder(const FabPlanner& planner, const rpc::Call&,
                                            const v1::HoldWorkOrderRequest& asked,
                                            store::Transaction& transaction) {
  RefreshAfterCommit(planner, asked.name(), transaction);
  return HoldOrder(asked.name(), transaction);
}

absl::StatusOr<Alarm> FindAlarm(const FabPlanner& planner, const rpc::Call&,
                                const v1::ResumeWorkOrderRequest& asked) {
  if (asked.machine().empty() && asked.bridge().empty()) return Alarm();
  if (!asked.name().empty()) {
    return InvalidField("machine", "is in place of a work order's name, not beside it");
  }
  if (asked.machine().empty()) return InvalidField("machine", "is missing");
  MORTISE_ASSIGN_OR_RETURN(v1::HeldMachine found,
                           planner.floor->FindAlarm(asked.bridge(), asked.machine()));
  return Alarm(std::move(found));
}

absl::StatusOr<v1::WorkOrder> ResumeWorkOrder(const FabPlanner& planner, const rpc::Call&,
                                              const v1::ResumeWorkOrderRequest& asked,
                                              const Alarm& alarm, store::Transaction& transaction) {
  if (alarm) return ClearAlarm(planner, *alarm, transaction);
  TellAfterCommit(planner, &ShopFloor::Resumed, asked.name(), transaction);
  return ResumeOrder(asked.name(), transaction);
}

}  // namespace mortise::fabplanner::methods
