// Unary calls without their types; used by the wrappers of handler.h.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <functional>
#include <memory>

#include "absl/status/status.h"
#include "common/rpc/call.h"
#include "common/rpc/call_state.h"

namespace mortise::store {
class Transaction;
}

namespace mortise::rpc {

// The reactor of a unary call. It lives until gRPC is done with it and nobody holds it any more.
class UnaryCall : public grpc::ServerUnaryReactor, public std::enable_shared_from_this<UnaryCall> {
 public:
  using Handler = std::function<void(const Call& call, const std::shared_ptr<UnaryCall>& unary)>;

  // What else is wrong with a request than numbers that are not finite and unknown enum values.
  using Explanation = std::function<absl::Status(const Call& call)>;

  // Checks the call on the dispatcher's threads, then runs `handler`, which (or what it leaves
  // behind) calls Complete. A request that is refused for its numbers is refused for what the
  // explanation tells as well, if there is one.
  static UnaryCall* Start(Dispatcher* dispatcher, const MethodInfo* method,
                          grpc::CallbackServerContext* context,
                          const google::protobuf::Message* request, Handler handler,
                          Explanation explanation = nullptr);

  // Whether the answer is the caller's to give: true for the first who asks. It may then write the
  // response, and must call Complete.
  bool Claim() { return !claimed_.exchange(true); }

  // Sends the response, or the failure.
  void Complete(const absl::Status& status);

  CallState& state() { return *state_; }

  void OnCancel() override { state_->Cancel(); }
  void OnDone() override { self_.reset(); }

 private:
  explicit UnaryCall(std::shared_ptr<CallState> state) : state_(std::move(state)) {}

  std::shared_ptr<CallState> state_;
  std::atomic<bool> claimed_ = false;
  std::shared_ptr<UnaryCall> self_;
};

// A call that changes something. `prepare` runs outside the transaction, may be slow and is skipped
// when the request was answered before; `change` runs inside (and again if the transaction is
// repeated). The same transaction holds the answer under its request_id and the audit record.
struct MutationSteps {
  std::function<absl::Status(const Call&)> prepare;  // may be unset
  // Whether `prepare` is run for requests that are refused for their numbers, too, only to tell
  // what else is wrong. It must refuse each of these numbers itself.
  bool prepare_tells_all = false;
  std::function<absl::Status(const Call&, store::Transaction&)> change;
};

UnaryCall* StartMutation(Dispatcher* dispatcher, const MethodInfo* method,
                         grpc::CallbackServerContext* context,
                         const google::protobuf::Message* request,
                         google::protobuf::Message* response, MutationSteps steps);

}  // namespace mortise::rpc
