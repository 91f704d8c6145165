// The methods of OperationService, of one process's own operations. operations.proto says what each
// takes and gives.
#pragma once

#include <functional>
#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_writer.h"
#include "common/store/store.h"
#include "mortise/v1/operations.pb.h"

namespace mortise::operations {
class Operations;
}

namespace mortise::rpc {

class Dispatcher;

// What the methods stand on; both outlive them.
struct HostedOperations {
  Dispatcher* dispatcher;
  operations::Operations* operations;
};

namespace methods {

absl::StatusOr<v1::Operation> GetOperation(const HostedOperations& host, const Call& call,
                                           const v1::GetOperationRequest& asked);

// The page token is the name of the last operation on the page before.
absl::StatusOr<v1::ListOperationsResponse> ListOperations(const HostedOperations& host,
                                                          const Call& call,
                                                          const v1::ListOperationsRequest& asked);

// Cancelling has a transaction of its own and may be repeated, so it goes before that of the call.
absl::StatusOr<v1::Operation> StopOperation(const HostedOperations& host, const Call& call,
                                            const v1::CancelOperationRequest& asked);
absl::StatusOr<v1::Operation> CancelOperation(const HostedOperations& host, const Call& call,
                                              const v1::CancelOperationRequest& asked,
                                              const v1::Operation& stopped,
                                              store::Transaction& transaction);

absl::Status WaitOperation(const HostedOperations& host, const Call& call,
                           const v1::WaitOperationRequest& asked,
                           const std::function<void(absl::StatusOr<v1::Operation>)>& respond);

absl::Status WatchOperation(const HostedOperations& host, const Call& call,
                            const v1::WatchOperationRequest& asked,
                            const std::shared_ptr<StreamWriter<v1::Operation>>& writer);

}  // namespace methods
}  // namespace mortise::rpc
