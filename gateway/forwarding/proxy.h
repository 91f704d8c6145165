// Passes every gRPC method on to the service that owns it, without decoding messages.
//
// One generic service receives all calls. Each is admitted (token, role), given a request id and a
// signed identity, and joined to a call of the same method on one of the service's channels.
// Messages travel as the byte buffers they came in. A message is read from one side only when the
// message before it has been written to the other: with the fixed flow-control windows of the two
// connections this bounds the memory of a stream, however fast one side and slow the other.
// Deadlines, cancellation, metadata, status and status details pass through in both directions.
//
// A stream ends with the token that it was begun with. Calls are counted by kind, subject and
// service, so that none takes what others need (open_calls.h). Compressed messages are expanded
// here, within the limit of messages and within a budget for those that become large, which gRPC's
// own count of memory does not see. What is large is let go as soon as it was passed on.
//
// Health and reflection are answered here, with or without a token, and are counted as well.
//
// Methods of OperationService and EventService that name an operation or a stream in their first
// message go to the service named there.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "gateway/admission/admission.h"
#include "gateway/admission/budget.h"
#include "gateway/admission/open_calls.h"
#include "gateway/contract/contract.h"
#include "gateway/forwarding/call_log.h"
#include "gateway/forwarding/upstreams.h"

namespace grpc {
class CallbackGenericService;
}

namespace mortise::gateway {

class HealthAnswers;
class Strangers;

// All must outlive the proxy.
struct ProxyOptions {
  const Contract* contract = nullptr;
  const Upstreams* upstreams = nullptr;
  Admission* admission = nullptr;
  OpenCalls* open_calls = nullptr;
  Budget* bodies = nullptr;  // bytes of what was expanded, by subject
  CallLog* log = nullptr;
  // Of the gRPC door, which sets these two itself.
  HealthAnswers* health = nullptr;
  Strangers* strangers = nullptr;
  std::chrono::milliseconds reflection_time{60000};  // of one stream
};

// Returns the generic service to register with a server. It also answers the health service, and
// the reflection service (grpc.reflection.v1alpha) for every method of the contract.
std::unique_ptr<grpc::CallbackGenericService> MakeProxy(const ProxyOptions& options);

// Returns the service a call goes to: the method's own, or the one its request names. `request` is
// the first message, serialised; read only where the route depends on it. INVALID_ARGUMENT naming
// the field, or NOT_FOUND, if it names none of `upstreams`.
absl::StatusOr<std::string> ServiceOf(const MethodRoute& method, std::string_view request,
                                      const Upstreams& upstreams);

// INVALID_ARGUMENT: a request that cannot be decoded.
absl::Status UnreadableRequest();

}  // namespace mortise::gateway
