// Releasing, pausing and finishing work orders: what FabPlannerService and its operations do with
// them in the store.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/operations/operations.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/fabplanner.pb.h"
#include "services/fabplanner/shop_floor/shop_floor.h"

namespace mortise::fabplanner {

// Writes a new order of the plan with all its cuts waiting, and starts its operation, in the
// caller's transaction; both have the tags of the request and the caller as their creator.
// INVALID_ARGUMENT naming the fields at fault; NOT_FOUND; FAILED_PRECONDITION, NOTHING_TO_CUT;
// RESOURCE_EXHAUSTED for orders that outgrow a message.
absl::StatusOr<operations::Operation> ReleaseOrder(const rpc::Call& call,
                                                   const v1::ReleaseWorkOrderRequest& request,
                                                   operations::Operations& operations,
                                                   store::Transaction& transaction);

// Pauses an order, or lets it go on; returns the order with its cuts. NOT_FOUND;
// FAILED_PRECONDITION, WORK_ORDER_FINISHED. ShopFloor::Refresh must follow the commit.
absl::StatusOr<v1::WorkOrder> HoldOrder(const std::string& name, store::Transaction& transaction);
absl::StatusOr<v1::WorkOrder> ResumeOrder(const std::string& name, store::Transaction& transaction);

// Cancels an order, unless it has ended already. NOT_FOUND. ShopFloor::Refresh must follow the
// commit.
absl::Status CancelOrder(const std::string& name, store::Transaction& transaction);

// Runs the operation of an order: waits until it ends. The packed v1::WorkOrder, or why it failed
// (FAILED_PRECONDITION, CUT_FAILED). Cancelling the operation cancels the order; a shutdown leaves
// it to be waited for again.
absl::StatusOr<std::string> RunWorkOrder(operations::OperationContext& context,
                                         operations::Operations& operations, store::Store& store,
                                         ShopFloor& floor);

}  // namespace mortise::fabplanner
