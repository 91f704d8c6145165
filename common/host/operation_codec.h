// Operations of common/operations as mortise.v1.Operation.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/operations/operations.h"

namespace google::protobuf {
class Message;
}
namespace mortise::v1 {
class Operation;
}

namespace mortise::rpc {

class Call;

// The operation that a call starts: `request` are its bytes, as its handler reads them.
jobs::NewOperation OperationOf(const Call& call, const std::string& kind,
                               const std::string& subject, std::string request);

// What an operation's handler returns: `result`, packed with its type.
std::string PackResult(const google::protobuf::Message& result);

// The operation as clients see it. A result that was not made by PackResult is left out.
v1::Operation ToProto(const jobs::Operation& operation);

// The states of common/operations that `states` names; INVALID_ARGUMENT naming the entry that is
// none.
absl::StatusOr<std::vector<jobs::OperationState>> StatesFrom(
    const google::protobuf::RepeatedField<int>& states);

}  // namespace mortise::rpc
