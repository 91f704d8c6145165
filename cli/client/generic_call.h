// Calls any method, with serialised messages or with messages whose type is not known before.
#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "cli/client/gateway_client.h"

namespace google::protobuf {
class Message;
class MethodDescriptor;
}  // namespace google::protobuf

namespace mortise::cli {

// Sends `request` to `method` ("/package.Service/Method") and hands over each response as it comes,
// until the server ends or `take` returns false. `seconds` 0 for no deadline.
absl::Status CallGeneric(const GatewayClient& client, const std::string& method,
                         const std::string& request, double seconds,
                         const std::function<bool(const std::string& response)>& take);

// The one answer of a method to one request, of the method's types.
absl::Status CallMethod(const GatewayClient& client,
                        const google::protobuf::MethodDescriptor& method,
                        const google::protobuf::Message& request,
                        google::protobuf::Message& response);

}  // namespace mortise::cli
