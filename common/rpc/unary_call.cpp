#include "common/rpc/unary_call.h"

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>

#include <optional>
#include <utility>

#include "common/base/errors.h"
#include "common/rpc/mutation_log.h"
#include "common/rpc/status_mapping.h"
#include "common/store/store.h"

namespace mortise::rpc {
namespace {

using google::protobuf::Message;

absl::Status RunMutationOnce(const Call& call, const CallState& state, const MutationKey& key,
                             const Message& request, Message* response,
                             const MutationSteps& steps) {
  store::Store* const store = state.dispatcher()->options().store;
  bool answered = false;
  const auto find_answer = [&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(answered, FindAnswer(transaction, key, response));
    return absl::OkStatus();
  };
  if (steps.prepare) {
    MORTISE_RETURN_IF_ERROR(store->Read(find_answer));
    if (answered) return absl::OkStatus();
    MORTISE_RETURN_IF_ERROR(steps.prepare(call));
  }
  return store->Transact([&](store::Transaction& transaction) -> absl::Status {
    // The store must not see exceptions of handlers.
    return state.RunGuarded([&]() -> absl::Status {
      MORTISE_RETURN_IF_ERROR(find_answer(transaction));
      if (answered) return absl::OkStatus();
      MORTISE_RETURN_IF_ERROR(steps.change(call, transaction));
      return RecordMutation(transaction, state.dispatcher()->options().service, call, key, request,
                            *response);
    });
  });
}

absl::Status RunMutation(const Call& call, const CallState& state, const Message& request,
                         Message* response, const MutationSteps& steps) {
  if (state.dispatcher()->options().store == nullptr) {
    return absl::InternalError("this process has no store to change");
  }
  MORTISE_ASSIGN_OR_RETURN(const MutationKey key, MakeMutationKey(call, request));
  for (int tried = 1;; ++tried) {
    absl::Status done = RunMutationOnce(call, state, key, request, response, steps);
    const bool again = TakesPreparingAgain(done);
    if (!again || tried == kMostPreparations || call.cancelled()) return done;
  }
}

}  // namespace

UnaryCall* UnaryCall::Start(Dispatcher* dispatcher, const MethodInfo* method,
                            grpc::CallbackServerContext* context, const Message* request,
                            Handler handler, Explanation explanation) {
  std::shared_ptr<UnaryCall> unary(
      new UnaryCall(std::make_shared<CallState>(dispatcher, method, *context)));
  unary->self_ = unary;
  if (absl::Status begun = unary->state_->Begin(); !begun.ok()) {
    unary->Complete(begun);
    return unary.get();
  }
  dispatcher->Submit(
      [unary, request, handler = std::move(handler), explanation = std::move(explanation)] {
        absl::Status status = unary->state_->Admit();
        if (status.ok()) {
          const auto explain = [&] { return explanation(Call(unary->state_)); };
          status = unary->state_->CheckRequest(
              *request, explanation ? std::function<absl::Status()>(explain) : nullptr);
        }
        if (status.ok()) {
          handler(Call(unary->state_), unary);
        } else if (unary->Claim()) {
          unary->Complete(status);
        }
      },
      method->lane);
  return unary.get();
}

void UnaryCall::Complete(const absl::Status& status) {
  state_->End(status);
  Finish(ToGrpc(status));
}

UnaryCall* StartMutation(Dispatcher* dispatcher, const MethodInfo* method,
                         grpc::CallbackServerContext* context, const Message* request,
                         Message* response, MutationSteps steps) {
  return UnaryCall::Start(
      dispatcher, method, context, request,
      [request, response, steps](const Call& call, const std::shared_ptr<UnaryCall>& unary) {
        const CallState& state = unary->state();
        const absl::Status status =
            state.RunGuarded([&] { return RunMutation(call, state, *request, response, steps); });
        if (unary->Claim()) unary->Complete(status);
      },
      steps.prepare_tells_all ? steps.prepare : nullptr);
}

}  // namespace mortise::rpc
