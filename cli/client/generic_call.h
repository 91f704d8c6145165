// Calls any method with serialised messages.
#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "cli/client/gateway_client.h"

namespace mortise::cli {

// Sends `request` to `method` ("/package.Service/Method") and hands over each response as it comes,
// until the server ends or `take` returns false. `seconds` 0 for no deadline.
absl::Status CallGeneric(const GatewayClient& client, const std::string& method,
                         const std::string& request, double seconds,
                         const std::function<bool(const std::string& response)>& take);

}  // namespace mortise::cli
