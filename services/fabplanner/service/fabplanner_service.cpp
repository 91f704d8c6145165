#include "services/fabplanner/service/fabplanner_service.h"

#include <algorithm>
#include <utility>

#include "common/base/errors.h"
#include "common/host/run_service.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/rpc/method_overrides.h"
#include "common/store/store.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "services/fabplanner/service/bridge_methods.h"
#include "services/fabplanner/service/fabplanner.h"
#include "services/fabplanner/service/plan_methods.h"
#include "services/fabplanner/service/plan_operation.h"
#include "services/fabplanner/service/work_order_methods.h"
#include "services/fabplanner/shop_floor/shop_floor.h"
#include "services/fabplanner/shop_floor/work_order_calls.h"

namespace mortise::fabplanner {
namespace {

// Commands that wait for a bridge's line: all cuts of a large order may be sent at once.
constexpr int kBridgeQueue = 20000;

// Operations that wait for machines hold a thread each; some must be left for planning.
constexpr int kThreadsForPlanning = 2;

class FabPlannerAdapter final : public v1::FabPlannerService::CallbackService {
  using Contract = v1::FabPlannerService::CallbackService;

 public:
  FabPlannerAdapter(rpc::ServiceEnvironment& environment, store::BlobFolder* blobs)
      : planning_(environment.peers, environment.signer, blobs),
        floor_(environment.store),
        planner_{.store = environment.store,
                 .operations = environment.operations,
                 .dispatcher = environment.dispatcher,
                 .blobs = blobs,
                 .planning = &planning_,
                 .floor = &floor_,
                 .most_orders =
                     std::max(1, environment.options.operation_threads - kThreadsForPlanning)},
        endpoint_(environment.dispatcher, "mortise.v1.FabPlannerService") {}

  absl::Status Open() {
    MORTISE_RETURN_IF_ERROR(floor_.Open());
    planner_.operations->Register(
        operations::kPlanOperation,
        [this](operations::OperationContext& context) { return planning_.Run(context); });
    planner_.operations->Register(
        operations::kWorkOrderOperation,
        [this](operations::OperationContext& context) {
          return RunWorkOrder(context, *planner_.operations, *planner_.store, floor_);
        },
        [this](store::Transaction& transaction, const operations::Operation& operation) {
          methods::RefreshAfterCommit(planner_, operation.subject, transaction);
          return CancelOrder(operation.subject, transaction);
        });
    return absl::OkStatus();
  }

  MORTISE_PREPARED_MUTATION(CreatePlan, rpc::With(planner_, methods::CheckPlan),
                            rpc::With(planner_, methods::CreatePlan))
  MORTISE_QUERY(GetPlan, rpc::With(planner_, methods::GetPlan))
  MORTISE_QUERY(ListPlans, rpc::With(planner_, methods::ListPlans))
  MORTISE_MUTATION(UpdatePlan, rpc::With(planner_, methods::UpdatePlan))
  MORTISE_SERVER_STREAM(DownloadArtifact, rpc::With(planner_, methods::DownloadArtifact))

  MORTISE_MUTATION(ReleaseWorkOrder, rpc::With(planner_, methods::ReleaseWorkOrder))
  MORTISE_QUERY(GetWorkOrder, rpc::With(planner_, methods::GetWorkOrder))
  MORTISE_QUERY(ListWorkOrders, rpc::With(planner_, methods::ListWorkOrders))
  MORTISE_MUTATION(UpdateWorkOrder, rpc::With(planner_, methods::UpdateWorkOrder))
  MORTISE_MUTATION(HoldWorkOrder, rpc::With(planner_, methods::HoldWorkOrder))
  MORTISE_PREPARED_MUTATION(ResumeWorkOrder, rpc::With(planner_, methods::FindAlarm),
                            rpc::With(planner_, methods::ResumeWorkOrder))

  MORTISE_BIDI(AttachBridge, rpc::With(planner_, methods::AttachBridge),
               {.capacity = kBridgeQueue, .endless = true})
  MORTISE_QUERY(ListBridges, rpc::With(planner_, methods::ListBridges))

 private:
  const PlanOperation planning_;
  ShopFloor floor_;
  const FabPlanner planner_;
  rpc::Endpoint endpoint_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment) {
  MORTISE_ASSIGN_OR_RETURN(store::BlobFolder * blobs, environment.store->Blobs());
  auto adapter = std::make_shared<FabPlannerAdapter>(environment, blobs);
  MORTISE_RETURN_IF_ERROR(adapter->Open());
  return std::vector<std::shared_ptr<grpc::Service>>{adapter};
}

}  // namespace mortise::fabplanner
