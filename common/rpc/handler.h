// From a generated CallbackService to plain functions: each override hands its call to an Endpoint,
// which runs a plain function on the handlers' threads. method_overrides.h writes the overrides.
//
// Before the function runs, the caller's identity is verified, its role compared with the method's
// rule (the proto option `mortise.v1.access`; a method without one is refused), and the request
// checked: numbers must be finite and enum values known (INVALID_ARGUMENT with the field's path).
// Afterwards the failure, if any, is sent with its details; an exception becomes INTERNAL. Log
// lines of the function carry the call's trace id.
//
// Include this in adapters (<name>_service.cpp) only: it brings gRPC.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/errors.h"
#include "common/rpc/call.h"
#include "common/rpc/call_state.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/page_tokens.h"
#include "common/rpc/stream_reactors.h"
#include "common/rpc/stream_writer.h"
#include "common/rpc/unary_call.h"

namespace mortise::rpc {

// Requests of streams without end say what to follow, and never come near this.
inline constexpr std::size_t kMaxBytesOfEndless = 64 * 1024;

// Answers an AsyncQuery. Only the first call counts; somebody must make it.
template <class Response>
using Responder = std::function<void(absl::StatusOr<Response>)>;

// When numbers of a request that are not finite, and enum values that nobody knows, are told.
enum class BadNumbers { kToldFirst, kToldWithAllElse };

// What else is wrong with a request than numbers that are not finite and unknown enum values.
template <class Request>
using Explanation =
    std::type_identity_t<std::function<absl::Status(const Call& call, const Request& request)>>;

class Endpoint {
 public:
  // `service` is the proto's full name. `dispatcher` must outlive it.
  Endpoint(Dispatcher* dispatcher, const std::string& service);

  // Answers a call that changes nothing (or nothing that is audited, such as a lease). Of a list,
  // the function takes and gives positions as page tokens (page_tokens.h). With `explanation`,
  // requests with numbers that are not finite are refused for what that tells, too.
  //   function(const Call&, const Request&) -> absl::StatusOr<Response>
  template <class Request, class Response, class Function>
  grpc::ServerUnaryReactor* Query(const char* method, grpc::CallbackServerContext* context,
                                  const Request* request, Response* response, Function function,
                                  const Explanation<Request>& explanation = nullptr) {
    return UnaryCall::Start(
        dispatcher_, &Find(method, false), context, request,
        [request, response, function = std::move(function)](
            const Call& call, const std::shared_ptr<UnaryCall>& unary) {
          absl::Status status = unary->state().RunGuarded([&]() -> absl::Status {
            MORTISE_ASSIGN_OR_RETURN(*response,
                                     WithPageTokens<Response>(*request, [&](const Request& r) {
                                       return absl::StatusOr<Response>(function(call, r));
                                     }));
            return absl::OkStatus();
          });
          if (unary->Claim()) unary->Complete(status);
        },
        Of(request, explanation));
  }

  // Answers a call that waits without holding a thread: for a task to lease, an operation to end.
  //   start(const Call&, const Request&, Responder<Response>) -> absl::Status
  // A failure returned is the answer; otherwise the responder gives it, from any thread. Let
  // Call::OnStop answer with what there is.
  template <class Request, class Response, class Start>
  grpc::ServerUnaryReactor* AsyncQuery(const char* method, grpc::CallbackServerContext* context,
                                       const Request* request, Response* response, Start start) {
    return UnaryCall::Start(
        dispatcher_, &Find(method, false), context, request,
        [request, response, start = std::move(start)](const Call& call,
                                                      const std::shared_ptr<UnaryCall>& unary) {
          Responder<Response> respond = [unary, response](absl::StatusOr<Response> answer) {
            if (!unary->Claim()) return;
            if (answer.ok()) *response = *std::move(answer);
            unary->Complete(answer.status());
          };
          // A copy, because the answer may come, and the request go, while `start` still runs.
          const Request kept = *request;
          absl::Status status = unary->state().RunGuarded(
              [&]() -> absl::Status { return start(call, kept, respond); });
          if (!status.ok() && unary->Claim()) unary->Complete(status);
        });
  }

  // Answers a call that changes something, in one transaction that also holds the audit record and
  // the answer under the request's `request_id`: the same request again gets the same answer and
  // changes nothing; another request under the same id is INVALID_ARGUMENT naming request_id.
  // The function may run again if the transaction is repeated, so it has no other effects.
  //   function(const Call&, const Request&, store::Transaction&) -> absl::StatusOr<Response>
  template <class Request, class Response, class Function>
  grpc::ServerUnaryReactor* Mutation(const char* method, grpc::CallbackServerContext* context,
                                     const Request* request, Response* response,
                                     Function function) {
    MutationSteps steps;
    steps.change = [request, response, function = std::move(function)](
                       const Call& call, store::Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(*response, function(call, *request, transaction));
      return absl::OkStatus();
    };
    return StartMutation(dispatcher_, &Find(method, true), context, request, response,
                         std::move(steps));
  }

  // The same for changes that need slow work first: what `prepare` returns, outside the
  // transaction, is given to `function`. Not run for a request answered before.
  // With BadNumbers::kToldWithAllElse, `prepare` refuses every number that is not finite itself,
  // and is run for such requests, too, to tell what else is wrong with them.
  //   prepare(const Call&, const Request&) -> absl::StatusOr<Prepared>
  //   function(const Call&, const Request&, Prepared&, store::Transaction&) -> StatusOr<Response>
  template <class Request, class Response, class Prepare, class Function>
  grpc::ServerUnaryReactor* PreparedMutation(const char* method,
                                             grpc::CallbackServerContext* context,
                                             const Request* request, Response* response,
                                             Prepare prepare, Function function,
                                             BadNumbers bad_numbers = BadNumbers::kToldFirst) {
    using Prepared =
        typename std::invoke_result_t<Prepare, const Call&, const Request&>::value_type;
    auto prepared = std::make_shared<std::optional<Prepared>>();
    MutationSteps steps;
    steps.prepare = [request, prepared,
                     prepare = std::move(prepare)](const Call& call) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(*prepared, prepare(call, *request));
      return absl::OkStatus();
    };
    steps.prepare_tells_all = bad_numbers == BadNumbers::kToldWithAllElse;
    steps.change = [request, response, prepared, function = std::move(function)](
                       const Call& call, store::Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(*response, function(call, *request, **prepared, transaction));
      return absl::OkStatus();
    };
    return StartMutation(dispatcher_, &Find(method, true), context, request, response,
                         std::move(steps));
  }

  // Answers a stream of answers (stream_writer.h). `start` sets it going and returns; keep `writer`
  // for later messages. The request lives only as long as `start` runs. A failure returned ends it.
  // `explanation` as for Query.
  //   start(const Call&, const Request&, std::shared_ptr<StreamWriter<Response>>) -> absl::Status
  template <class Response, class Request, class StartFunction>
  grpc::ServerWriteReactor<Response>* ServerStream(
      const char* method, grpc::CallbackServerContext* context, const Request* request,
      StartFunction start, const StreamOptions& options = {},
      const Explanation<Request>& explanation = nullptr) {
    return ServerStreamReactor<Response>::Start(
        NewCall(method, *context), request, options,
        [request, endless = options.endless, start = std::move(start)](
            const Call& call,
            const std::shared_ptr<StreamWriter<Response>>& writer) -> absl::Status {
          // gRPC keeps the request for as long as the stream.
          if (endless && request->ByteSizeLong() > kMaxBytesOfEndless) {
            return TooLarge("the request of a stream without end", "64 KiB");
          }
          return start(call, *request, writer);
        },
        Of(request, explanation));
  }

  // Returns a stream of requests with one answer.
  //   open(const Call&) -> absl::StatusOr<std::unique_ptr<UploadReader<Request, Response>>>
  template <class Request, class Response, class Open>
  grpc::ServerReadReactor<Request>* Upload(const char* method, grpc::CallbackServerContext* context,
                                           Response* response, Open open) {
    return UploadReactor<Request, Response>::Start(NewCall(method, *context), response,
                                                   std::move(open));
  }

  // Streams both ways.
  //   open(const Call&, std::shared_ptr<StreamWriter<Response>>)
  //       -> absl::StatusOr<std::unique_ptr<StreamReader<Request>>>
  template <class Request, class Response, class Open>
  grpc::ServerBidiReactor<Request, Response>* Bidi(const char* method,
                                                   grpc::CallbackServerContext* context, Open open,
                                                   const StreamOptions& options = {}) {
    return BidiReactor<Request, Response>::Start(NewCall(method, *context), options,
                                                 std::move(open));
  }

 private:
  // Returns the explanation of this request, which must live as long as it is used; empty for an
  // empty one.
  template <class Request>
  static UnaryCall::Explanation Of(const Request* request,
                                   const Explanation<Request>& explanation) {
    if (!explanation) return nullptr;
    return [request, explanation](const Call& call) { return explanation(call, *request); };
  }

  // Returns the method's rule. `mutation`: whether the wrapper used is one for methods that mutate;
  // if that is not what the proto says, every call is refused.
  const MethodInfo& Find(const std::string& method, bool mutation) const;
  std::shared_ptr<CallState> NewCall(const char* method,
                                     const grpc::CallbackServerContext& context) const;

  Dispatcher* const dispatcher_;
  std::map<std::string, MethodInfo> methods_;
  MethodInfo unknown_;
  MethodInfo misused_;
};

}  // namespace mortise::rpc
