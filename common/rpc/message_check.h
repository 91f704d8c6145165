// What no handler should have to check: numbers are finite, enum values known.
#pragma once

#include "absl/status/status.h"

namespace google::protobuf {
class Message;
}

namespace mortise::rpc {

// INVALID_ARGUMENT with the path of the first field, in the order of field numbers, that holds NaN,
// an infinity, or a number that its enum does not have. Any fields are not looked into.
absl::Status CheckMessage(const google::protobuf::Message& message);

}  // namespace mortise::rpc
