// The methods of bridges: the stream that one attaches by, and those there are.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_reactors.h"
#include "mortise/v1/fabplanner.pb.h"
#include "services/fabplanner/service/fabplanner.h"
#include "services/fabplanner/shop_floor/shop_floor.h"

namespace mortise::fabplanner::methods {

absl::StatusOr<std::unique_ptr<rpc::StreamReader<v1::BridgeMessage>>> AttachBridge(
    const FabPlanner& planner, const rpc::Call& call, ShopFloor::Writer writer);

absl::StatusOr<v1::ListBridgesResponse> ListBridges(const FabPlanner& planner,
                                                    const rpc::Call& call,
                                                    const v1::ListBridgesRequest& asked);

}  // namespace mortise::fabplanner::methods
