#include "services/fabplanner/shop_floor/order_records.h"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "services/fabplanner/shop_floor/plan_codec.h"

namespace mortise::fabplanner {
namespace {

constexpr char kCutKind[] = "cuts";
constexpr char kBridgeKind[] = "bridges";
constexpr int kPageSize = 1000;

std::string IdOf(const std::string& order_name) {
  return std::string(absl::StripPrefix(order_name, "workOrders/"));
}

std::string CutKey(const std::string& order_name, int index) {
  return absl::StrFormat("%s/%06d", IdOf(order_name), index);
}

// Calls `use` with each record of a kind.
template <class Message, class Use>
absl::Status ForEach(store::ReadTransaction& transaction, const char* kind,
                     const std::string& prefix, Use use) {
  store::ListOptions options;
  options.key_prefix = prefix;
  options.limit = kPageSize;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page,
                             transaction.List(kind, options));
    for (const store::Record& record : page) {
      MORTISE_ASSIGN_OR_RETURN(Message message,
                               resources::ParseRecord<Message>(record.kind, record));
      use(std::move(message));
    }
    if (static_cast<int>(page.size()) < kPageSize) return absl::OkStatus();
    options.after_key = page.back().key;
  }
}

const char* CutEventType(CutState state) {
  switch (state) {
    case CutState::kWaiting:
      return "cut.waiting";
    case CutState::kSent:
      return "cut.ordered";
    case CutState::kAccepted:
      return "cut.accepted";
    case CutState::kCut:
      return "cut.finished";
    case CutState::kRejected:
      return "cut.rejected";
    case CutState::kFailed:
      return "cut.failed";
  }
  return "cut.unknown";
}

const char* OrderEventType(v1::WorkOrder::State state) {
  switch (state) {
    case v1::WorkOrder::RELEASED:
      return "workOrder.released";
    case v1::WorkOrder::IN_PROGRESS:
      return "workOrder.started";
    case v1::WorkOrder::HELD:
      return "workOrder.held";
    case v1::WorkOrder::COMPLETED:
      return "workOrder.completed";
    case v1::WorkOrder::FAILED:
      return "workOrder.failed";
    case v1::WorkOrder::CANCELLED:
      return "workOrder.cancelled";
    default:
      return "workOrder.changed";
  }
}

// Text of others may hold bytes that are not UTF-8; an event must not fail for that.
std::string Dump(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

absl::Status PutOrder(store::Transaction& transaction, const v1::WorkOrder& order) {
  return transaction.Put(kOrders.kind, IdOf(order.name()), order.SerializeAsString()).status();
}

absl::Status PutCut(store::Transaction& transaction, const std::string& order_name, int index,
                    const Cut& cut) {
  return transaction
      .Put(kCutKind, CutKey(order_name, index), ToProto(cut, order_name).SerializeAsString())
      .status();
}

absl::StatusOr<v1::WorkOrder> GetOrder(store::ReadTransaction& transaction,
                                       const std::string& order_name) {
  const absl::StatusOr<store::Record> record = transaction.Get(kOrders.kind, IdOf(order_name));
  if (absl::IsNotFound(record.status())) return ResourceNotFound(order_name);
  if (!record.ok()) return record.status();
  return resources::ParseRecord<v1::WorkOrder>(kOrders.kind, *record);
}

absl::StatusOr<std::vector<v1::WorkOrder::Cut>> GetCuts(store::ReadTransaction& transaction,
                                                        const std::string& order_name) {
  std::vector<v1::WorkOrder::Cut> cuts;
  MORTISE_RETURN_IF_ERROR(
      ForEach<v1::WorkOrder::Cut>(transaction, kCutKind, absl::StrCat(IdOf(order_name), "/"),
                                  [&](v1::WorkOrder::Cut cut) { cuts.push_back(std::move(cut)); }));
  return cuts;
}

absl::StatusOr<v1::WorkOrder> GetWholeOrder(store::ReadTransaction& transaction,
                                            const std::string& order_name) {
  MORTISE_ASSIGN_OR_RETURN(v1::WorkOrder order, GetOrder(transaction, order_name));
  MORTISE_ASSIGN_OR_RETURN(std::vector<v1::WorkOrder::Cut> cuts, GetCuts(transaction, order_name));
  std::stable_sort(
      cuts.begin(), cuts.end(), [](const v1::WorkOrder::Cut& a, const v1::WorkOrder::Cut& b) {
        const auto key = [](const v1::WorkOrder::Cut& cut) {
          return std::make_tuple(cut.bridge().empty(), std::cref(cut.bridge()),
                                 std::cref(cut.command().machine()), cut.command().sequence());
        };
        return key(a) < key(b);
      });
  for (v1::WorkOrder::Cut& cut : cuts) *order.add_cuts() = std::move(cut);
  return order;
}

absl::Status PutBridge(store::Transaction& transaction,
                       const v1::ListBridgesResponse::Bridge& bridge) {
  return transaction.Put(kBridgeKind, bridge.name(), bridge.SerializeAsString()).status();
}

absl::StatusOr<std::vector<v1::ListBridgesResponse::Bridge>> GetBridges(
    store::ReadTransaction& transaction) {
  std::vector<v1::ListBridgesResponse::Bridge> bridges;
  MORTISE_RETURN_IF_ERROR(ForEach<v1::ListBridgesResponse::Bridge>(
      transaction, kBridgeKind, "",
      [&](v1::ListBridgesResponse::Bridge bridge) { bridges.push_back(std::move(bridge)); }));
  return bridges;
}

absl::Status AppendCutEvent(store::Transaction& transaction, const std::string& order_name,
                            const Cut& cut) {
  nlohmann::json json = {{"bridge", cut.bridge},
                         {"machine", cut.machine},
                         {"sequence", cut.sequence},
                         {"part", cut.part},
                         {"stock", cut.stock}};
  if (cut.seconds > 0) json["seconds"] = cut.seconds;
  if (!cut.message.empty()) json["message"] = cut.message;
  return transaction.AppendEvent({.type = CutEventType(cut.state),
                                  .subject = order_name,
                                  .payload = Dump(json),
                                  .trace_id = CurrentTraceId()});
}

absl::Status AppendOrderEvent(store::Transaction& transaction, const v1::WorkOrder& order) {
  const nlohmann::json json = {{"plan", order.plan()},
                               {"cutsDone", order.cuts_done()},
                               {"cutsTotal", order.cuts_total()},
                               {"operation", order.operation()}};
  return transaction.AppendEvent({.type = OrderEventType(order.state()),
                                  .subject = order.name(),
                                  .payload = Dump(json),
                                  .trace_id = CurrentTraceId()});
}

}  // namespace mortise::fabplanner
