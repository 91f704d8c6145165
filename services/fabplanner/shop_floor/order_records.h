// Work orders, their cuts and bridges in the store: the command log.
//
// A work order is one record (kind "workOrders", without cuts); each cut is one of its own (kind
// "cuts", key "<order>/<number>"), so that a report rewrites a few hundred bytes however large the
// order. Bridges are kept by name (kind "bridges") with the reports stored of each.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/resources/collection.h"
#include "common/store/store.h"
#include "mortise/v1/fabplanner.pb.h"
#include "services/fabplanner/shop_floor/work_order.h"

namespace mortise::fabplanner {

inline constexpr resources::Collection<v1::WorkOrder> kOrders{
    .names = "workOrders", .kind = "workOrders", .event = "workOrder"};

// Largest message that is stored and sent, below gRPC's 4 MiB, bytes.
inline constexpr int kMaxMessageBytes = 4000000;

// Writes the order's record; `order` has no cuts.
absl::Status PutOrder(store::Transaction& transaction, const v1::WorkOrder& order);

// Writes cut `index` of the order.
absl::Status PutCut(store::Transaction& transaction, const std::string& order_name, int index,
                    const Cut& cut);

// Returns the order without its cuts. NOT_FOUND naming it.
absl::StatusOr<v1::WorkOrder> GetOrder(store::ReadTransaction& transaction,
                                       const std::string& order_name);

// Returns all cuts of the order, in cutting order.
absl::StatusOr<std::vector<v1::WorkOrder::Cut>> GetCuts(store::ReadTransaction& transaction,
                                                        const std::string& order_name);

// Returns the order with its cuts by machine and sequence, those that wait last.
absl::StatusOr<v1::WorkOrder> GetWholeOrder(store::ReadTransaction& transaction,
                                            const std::string& order_name);

absl::Status PutBridge(store::Transaction& transaction,
                       const v1::ListBridgesResponse::Bridge& bridge);
absl::StatusOr<std::vector<v1::ListBridgesResponse::Bridge>> GetBridges(
    store::ReadTransaction& transaction);

// Tells of a cut's new state: cut.ordered, cut.accepted, cut.finished, cut.rejected, cut.failed.
absl::Status AppendCutEvent(store::Transaction& transaction, const std::string& order_name,
                            const Cut& cut);

// Tells of the order's new state: workOrder.released, .started, .held, .completed, .failed,
// .cancelled.
absl::Status AppendOrderEvent(store::Transaction& transaction, const v1::WorkOrder& order);

}  // namespace mortise::fabplanner
