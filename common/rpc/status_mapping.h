// Failures on the wire: absl::Status to grpc::Status and back without loss.
//
// The reason and the field of common/base/errors.h travel as a google.rpc.Status in
// `grpc-status-details-bin`: an ErrorInfo with the reason (domain "mortise.dev"), and for
// INVALID_ARGUMENT a BadRequest naming the field; other codes name the resource in the ErrorInfo.
#pragma once

#include "absl/status/status.h"

namespace grpc {
class Status;
}
namespace google::rpc {
class Status;
}

namespace mortise::rpc {

// Never UNKNOWN: that code becomes INTERNAL.
grpc::Status ToGrpc(const absl::Status& status);
absl::Status FromGrpc(const grpc::Status& status);

// The same as a message: Operation.error, results of tasks.
google::rpc::Status ToProto(const absl::Status& status);
absl::Status FromProto(const google::rpc::Status& status);

}  // namespace mortise::rpc
