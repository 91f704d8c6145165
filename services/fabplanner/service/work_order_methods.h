// The methods of work orders: released, read, listed, found by their tags, paused and resumed.
// fabplanner.proto says what each takes and gives; the wrappers of common/rpc what all have.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/fabplanner.pb.h"
#include "services/fabplanner/service/fabplanner.h"

namespace mortise::fabplanner::methods {

absl::StatusOr<v1::Operation> ReleaseWorkOrder(const FabPlanner& planner, const rpc::Call& call,
                                               const v1::ReleaseWorkOrderRequest& asked,
                                               store::Transaction& transaction);

absl::StatusOr<v1::WorkOrder> GetWorkOrder(const FabPlanner& planner, const rpc::Call& call,
                                           const v1::GetWorkOrderRequest& asked);

absl::StatusOr<v1::ListWorkOrdersResponse> ListWorkOrders(const FabPlanner& planner,
                                                          const rpc::Call& call,
                                                          const v1::ListWorkOrdersRequest& asked);

absl::StatusOr<v1::WorkOrder> UpdateWorkOrder(const FabPlanner& planner, const rpc::Call& call,
                                              const v1::UpdateWorkOrderRequest& asked,
                                              store::Transaction& transaction);

absl::StatusOr<v1::WorkOrder> HoldWorkOrder(const FabPlanner& planner, const rpc::Call& call,
                                            const v1::HoldWorkOrderRequest& asked,
                                            store::Transaction& transaction);

// The alarm that a request to resume clears; nothing where it resumes an order.
using Alarm = std::optional<v1::HeldMachine>;

absl::StatusOr<Alarm> FindAlarm(const FabPlanner& planner, const rpc::Call& call,
                                const v1::ResumeWorkOrderRequest& asked);
absl::StatusOr<v1::WorkOrder> ResumeWorkOrder(const FabPlanner& planner, const rpc::Call& call,
                                              const v1::ResumeWorkOrderRequest& asked,
                                              const Alarm& alarm, store::Transaction& transaction);

// Has the shop floor take over, after the commit, what the transaction stores of an order.
void RefreshAfterCommit(const FabPlanner& planner, const std::string& order_name,
                        store::Transaction& transaction);

}  // namespace mortise::fabplanner::methods
