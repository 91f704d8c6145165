#include "services/fabplanner/service/fabplanner_service.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/base/violation_lists.h"
#include "common/host/chunk_stream.h"
#include "common/host/operation_codec.h"
#include "common/host/run_service.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/resources/record_page.h"
#include "common/rpc/channel.h"
#include "common/rpc/handler.h"
#include "common/store/store.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "services/fabplanner/service/plan_operation.h"
#include "services/fabplanner/shop_floor/order_records.h"
#include "services/fabplanner/shop_floor/shop_floor.h"
#include "services/fabplanner/shop_floor/work_order_calls.h"

namespace mortise::fabplanner {
namespace {

// Commands that wait for a bridge's line: all cuts of a large order may be sent at once.
constexpr int kBridgeQueue = 20000;

// Operations that wait for machines hold a thread each; some must be left for planning.
constexpr int kThreadsForPlanning = 2;

// The page of a List request, from the newest record down.
template <typename Message, typename Request>
absl::StatusOr<resources::Page<Message>> ListNewestFirst(store::Store& store, const char* kind,
                                                         const Request& asked) {
  MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
  resources::Page<Message> page;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(page, resources::ReadPage<Message>(
                                       transaction, {.kind = kind, .newest_first = true}, query));
    return absl::OkStatus();
  }));
  return page;
}

// The messages of one bridge's stream.
class BridgeStream : public rpc::StreamReader<v1::BridgeMessage> {
 public:
  BridgeStream(ShopFloor* floor, ShopFloor::Writer writer)
      : floor_(floor), writer_(std::move(writer)) {}

  absl::Status OnMessage(const v1::BridgeMessage& message) override {
    if (attachment_ != 0) return floor_->Receive(attachment_, message);
    if (!message.has_hello()) return InvalidField("message", "the first must be a hello");
    MORTISE_ASSIGN_OR_RETURN(attachment_, floor_->Attach(message.hello(), writer_));
    return absl::OkStatus();
  }

  void OnEnd() override {
    if (attachment_ == 0) {
      // It may also have sent a first message that is none.
      writer_->Finish(InvalidField("message", "no hello was sent"));
      return;
    }
    floor_->Detach(attachment_);
    writer_->Finish(absl::OkStatus());
  }

 private:
  ShopFloor* const floor_;
  const ShopFloor::Writer writer_;
  int64_t attachment_ = 0;
};

class FabPlannerAdapter final : public v1::FabPlannerService::CallbackService {
 public:
  FabPlannerAdapter(rpc::ServiceEnvironment& environment, store::BlobFolder* blobs)
      : store_(environment.store),
        operations_(environment.operations),
        dispatcher_(environment.dispatcher),
        blobs_(blobs),
        most_orders_(std::max(1, environment.options.operation_threads - kThreadsForPlanning)),
        endpoint_(environment.dispatcher, "mortise.v1.FabPlannerService"),
        planner_(environment.peers, environment.signer, blobs),
        floor_(environment.store) {}

  absl::Status Open() {
    MORTISE_RETURN_IF_ERROR(floor_.Open());
    operations_->Register(jobs::kPlanOperation, [this](jobs::OperationContext& context) {
      return planner_.Run(context);
    });
    operations_->Register(
        jobs::kWorkOrderOperation,
        [this](jobs::OperationContext& context) {
          return RunWorkOrder(context, *operations_, *store_, floor_);
        },
        [this](store::Transaction& transaction, const jobs::Operation& operation) {
          TellFloorAfterCommit(&ShopFloor::Refresh, operation.subject, transaction);
          return CancelOrder(operation.subject, transaction);
        });
    return absl::OkStatus();
  }

  grpc::ServerUnaryReactor* CreatePlan(grpc::CallbackServerContext* context,
                                       const v1::CreatePlanRequest* request,
                                       v1::Operation* response) override {
    struct Checked {};
    return endpoint_.PreparedMutation(
        "CreatePlan", context, request, response,
        [this](const rpc::Call& call,
               const v1::CreatePlanRequest& asked) -> absl::StatusOr<Checked> {
          const absl::Status checked = CheckRequest(asked);
          // What is wrong with the parameters is told with the rest, where a template is named.
          const bool names_template = CheckTemplate(asked).ok();
          MORTISE_RETURN_IF_ERROR(Together(
              checked, names_template ? planner_.CheckDesign(asked, rpc::ForwardedFrom(call))
                                      : absl::OkStatus()));
          return Checked();
        },
        [this](const rpc::Call& call, const v1::CreatePlanRequest& asked, const Checked&,
               store::Transaction& transaction) -> absl::StatusOr<v1::Operation> {
          MORTISE_ASSIGN_OR_RETURN(
              const jobs::Operation operation,
              operations_->Start(transaction, rpc::OperationOf(call, jobs::kPlanOperation,
                                                               asked.template_(), asked)));
          return rpc::ToProto(operation);
        });
  }

  grpc::ServerUnaryReactor* GetPlan(grpc::CallbackServerContext* context,
                                    const v1::GetPlanRequest* request,
                                    v1::Plan* response) override {
    return endpoint_.Query("GetPlan", context, request, response,
                           [this](const rpc::Call&, const v1::GetPlanRequest& asked) {
                             return FindPlan(asked.name());
                           });
  }

  grpc::ServerUnaryReactor* ListPlans(grpc::CallbackServerContext* context,
                                      const v1::ListPlansRequest* request,
                                      v1::ListPlansResponse* response) override {
    return endpoint_.Query(
        "ListPlans", context, request, response,
        [this](const rpc::Call&,
               const v1::ListPlansRequest& asked) -> absl::StatusOr<v1::ListPlansResponse> {
          MORTISE_ASSIGN_OR_RETURN(auto page,
                                   ListNewestFirst<v1::Plan>(*store_, kPlanSummaryKind, asked));
          v1::ListPlansResponse answer;
          for (v1::Plan& plan : page.entries) *answer.add_plans() = std::move(plan);
          answer.set_next_page_token(page.next_page_token);
          return answer;
        });
  }

  grpc::ServerWriteReactor<v1::Chunk>* DownloadArtifact(
      grpc::CallbackServerContext* context, const v1::DownloadArtifactRequest* request) override {
    return endpoint_.ServerStream<v1::Chunk>(
        "DownloadArtifact", context, request,
        [this](const rpc::Call&, const v1::DownloadArtifactRequest& asked,
               const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(const v1::Plan plan, FindPlan(asked.name()));
          return rpc::StreamArtifact(blobs_, asked.name(), plan.artifacts(), asked.file_name(),
                                     writer);
        });
  }

  grpc::ServerUnaryReactor* ReleaseWorkOrder(grpc::CallbackServerContext* context,
                                             const v1::ReleaseWorkOrderRequest* request,
                                             v1::Operation* response) override {
    return endpoint_.Mutation(
        "ReleaseWorkOrder", context, request, response,
        [this](const rpc::Call& call, const v1::ReleaseWorkOrderRequest& asked,
               store::Transaction& transaction) -> absl::StatusOr<v1::Operation> {
          if (floor_.OrdersUnderWay() >= most_orders_) {
            return TooLarge("another work order",
                            absl::StrCat(most_orders_, " under way at a time"));
          }
          MORTISE_ASSIGN_OR_RETURN(const jobs::Operation operation,
                                   ReleaseOrder(call, asked, *operations_, transaction));
          TellFloorAfterCommit(&ShopFloor::Refresh, operation.subject, transaction);
          return rpc::ToProto(operation);
        });
  }

  grpc::ServerUnaryReactor* GetWorkOrder(grpc::CallbackServerContext* context,
                                         const v1::GetWorkOrderRequest* request,
                                         v1::WorkOrder* response) override {
    return endpoint_.Query(
        "GetWorkOrder", context, request, response,
        [this](const rpc::Call&,
               const v1::GetWorkOrderRequest& asked) -> absl::StatusOr<v1::WorkOrder> {
          MORTISE_RETURN_IF_ERROR(ParseResourceName(asked.name(), "workOrders", "name").status());
          v1::WorkOrder order;
          MORTISE_RETURN_IF_ERROR(
              store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
                MORTISE_ASSIGN_OR_RETURN(order, GetWholeOrder(transaction, asked.name()));
                return absl::OkStatus();
              }));
          for (v1::HeldMachine& held : floor_.HeldMachines(asked.name())) {
            *order.add_held_machines() = std::move(held);
          }
          return order;
        });
  }

  grpc::ServerUnaryReactor* ListWorkOrders(grpc::CallbackServerContext* context,
                                           const v1::ListWorkOrdersRequest* request,
                                           v1::ListWorkOrdersResponse* response) override {
    return endpoint_.Query("ListWorkOrders", context, request, response,
                           [this](const rpc::Call&, const v1::ListWorkOrdersRequest& asked)
                               -> absl::StatusOr<v1::ListWorkOrdersResponse> {
                             MORTISE_ASSIGN_OR_RETURN(auto page, ListNewestFirst<v1::WorkOrder>(
                                                                     *store_, kOrderKind, asked));
                             v1::ListWorkOrdersResponse answer;
                             for (v1::WorkOrder& order : page.entries)
                               *answer.add_work_orders() = std::move(order);
                             answer.set_next_page_token(page.next_page_token);
                             return answer;
                           });
  }

  grpc::ServerUnaryReactor* HoldWorkOrder(grpc::CallbackServerContext* context,
                                          const v1::HoldWorkOrderRequest* request,
                                          v1::WorkOrder* response) override {
    return endpoint_.Mutation("HoldWorkOrder", context, request, response,
                              [this](const rpc::Call&, const v1::HoldWorkOrderRequest& asked,
                                     store::Transaction& transaction) {
                                TellFloorAfterCommit(&ShopFloor::Refresh, asked.name(),
                                                     transaction);
                                return HoldOrder(asked.name(), transaction);
                              });
  }

  grpc::ServerUnaryReactor* ResumeWorkOrder(grpc::CallbackServerContext* context,
                                            const v1::ResumeWorkOrderRequest* request,
                                            v1::WorkOrder* response) override {
    using Alarm = std::optional<v1::HeldMachine>;
    return endpoint_.PreparedMutation(
        "ResumeWorkOrder", context, request, response,
        [this](const rpc::Call&, const v1::ResumeWorkOrderRequest& asked) -> absl::StatusOr<Alarm> {
          if (asked.machine().empty() && asked.bridge().empty()) return Alarm();
          if (!asked.name().empty()) {
            return InvalidField("machine", "is in place of a work order's name, not beside it");
          }
          if (asked.machine().empty()) return InvalidField("machine", "is missing");
          MORTISE_ASSIGN_OR_RETURN(v1::HeldMachine found,
                                   floor_.FindAlarm(asked.bridge(), asked.machine()));
          return Alarm(std::move(found));
        },
        [this](const rpc::Call&, const v1::ResumeWorkOrderRequest& asked, const Alarm& alarm,
               store::Transaction& transaction) -> absl::StatusOr<v1::WorkOrder> {
          if (alarm) return ClearAlarm(*alarm, transaction);
          TellFloorAfterCommit(&ShopFloor::Resumed, asked.name(), transaction);
          return ResumeOrder(asked.name(), transaction);
        });
  }

  grpc::ServerBidiReactor<v1::BridgeMessage, v1::PlannerMessage>* AttachBridge(
      grpc::CallbackServerContext* context) override {
    return endpoint_.Bidi<v1::BridgeMessage, v1::PlannerMessage>(
        "AttachBridge", context,
        [this](const rpc::Call&, ShopFloor::Writer writer)
            -> absl::StatusOr<std::unique_ptr<rpc::StreamReader<v1::BridgeMessage>>> {
          return std::make_unique<BridgeStream>(&floor_, std::move(writer));
        },
        {.capacity = kBridgeQueue, .endless = true});
  }

  grpc::ServerUnaryReactor* ListBridges(grpc::CallbackServerContext* context,
                                        const v1::ListBridgesRequest* request,
                                        v1::ListBridgesResponse* response) override {
    return endpoint_.Query(
        "ListBridges", context, request, response,
        [this](const rpc::Call&,
               const v1::ListBridgesRequest&) -> absl::StatusOr<v1::ListBridgesResponse> {
          v1::ListBridgesResponse answer;
          for (v1::ListBridgesResponse::Bridge& bridge : floor_.Bridges()) {
            *answer.add_bridges() = std::move(bridge);
          }
          return answer;
        });
  }

 private:
  absl::StatusOr<v1::Plan> FindPlan(const std::string& name) {
    MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, "plans", "name"));
    v1::Plan plan;
    MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      const absl::StatusOr<store::Record> record = transaction.Get(kPlanKind, id);
      if (absl::IsNotFound(record.status())) return ResourceNotFound(name);
      MORTISE_RETURN_IF_ERROR(record.status());
      if (plan.ParseFromString(record->payload)) return absl::OkStatus();
      return StorageFailed(name, "the plan is not readable");
    }));
    return plan;
  }

  // Tells the shop floor, on another thread: this one may still hold the store.
  void TellFloorAfterCommit(absl::Status (ShopFloor::*tell)(const std::string&),
                            const std::string& order_name, store::Transaction& transaction) {
    transaction.AfterCommit([this, tell, order_name] {
      dispatcher_->Submit(
          [this, tell, order_name] {
            const absl::Status status = (floor_.*tell)(order_name);
            if (status.ok()) return;
            Log(LogLevel::kWarning, "work order not taken up",
                {{"work_order", order_name}, {"error", status.message()}});
          },
          rpc::Lane::kUrgent);
    });
  }

  // The same for an alarm; the answer has its machine alone.
  v1::WorkOrder ClearAlarm(const v1::HeldMachine& alarm, store::Transaction& transaction) {
    transaction.AfterCommit([this, alarm] {
      dispatcher_->Submit(
          [this, alarm] { floor_.ClearAlarm(alarm.bridge(), alarm.machine().name()); },
          rpc::Lane::kUrgent);
    });
    v1::WorkOrder answer;
    *answer.add_held_machines() = alarm;
    return answer;
  }

  store::Store* const store_;
  jobs::Operations* const operations_;
  rpc::Dispatcher* const dispatcher_;
  store::BlobFolder* const blobs_;
  const int most_orders_;
  rpc::Endpoint endpoint_;
  PlanOperation planner_;
  ShopFloor floor_;
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
