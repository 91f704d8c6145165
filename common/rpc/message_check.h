// What no handler should have to check: numbers are finite, enum values known.
#pragma once

#include "absl/status/status.h"

namespace google::protobuf {
class Message;
}

namespace mortise::rpc {

// Fails with INVALID_ARGUMENT with the paths of the fields, in the order of field numbers and the
// first 40 or so, that hold NaN, an infinity, or a number that their enum does not have. NaN is
// right where the contract says that it stands for what is not known (HeightGrid.heights). Any
// fields are not looked into.
absl::Status CheckMessage(const google::protobuf::Message& message);

}  // namespace mortise::rpc
