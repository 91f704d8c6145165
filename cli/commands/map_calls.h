// Asks for what the commands of `mortise map` have in common.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"
#include "mortise/v1/interpolator.grpc.pb.h"

namespace mortise::cli {

// Returns the map "maps/0198c1", which may be called "0198c1". NOT_FOUND.
absl::StatusOr<v1::DesignMap> GetMap(const GatewayClient& client, const std::string& name);

// Returns the designs that --at was given, one after the other. INVALID_ARGUMENT naming "--at" as
// ParseMapPoint does.
absl::StatusOr<std::vector<double>> PointsAt(const v1::DesignMap& map,
                                             const std::vector<std::string>& at);

}  // namespace mortise::cli
