// Calling other services: channels, contexts that carry identity, trace and deadline, and retries.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/rpc/call.h"
#include "common/rpc/channel_security.h"
#include "common/rpc/identity.h"

namespace grpc {
class Channel;
class ClientContext;
class Status;
}  // namespace grpc

namespace mortise::rpc {

// Returns a channel that connects, and reconnects, by itself. Fails as MakeClientCredentials does.
absl::StatusOr<std::shared_ptr<grpc::Channel>> MakeChannel(const std::string& address,
                                                           const ChannelSecurity& security);

// On whose behalf, and until when, a call is made.
struct Origin {
  std::function<std::string()> identity =
      nullptr;  // the signed identity to send; unset in development
  std::string trace_id = {};
  absl::Time deadline = absl::InfiniteFuture();
};

// Returns a call that the caller of `call` makes: same identity, trace and deadline.
Origin ForwardedFrom(const Call& call);

// Returns the service itself calls, in the background: a fresh identity ("services/<name>") for
// each try. `signer` may be null (development) and must outlive the origin.
Origin OwnOrigin(const IdentitySigner* signer, Role role, std::string trace_id,
                 absl::Duration timeout);

// Returns a context for one call.
std::unique_ptr<grpc::ClientContext> MakeClientContext(const Origin& origin);

// How a failed unary call is repeated: only if UNAVAILABLE, after a random back-off that doubles
// from `first_delay` to `longest_delay`, until the origin's deadline or `patience` has passed.
struct RetryOptions {
  absl::Duration first_delay = absl::Milliseconds(50);
  absl::Duration longest_delay = absl::Seconds(2);
  absl::Duration patience = absl::Seconds(10);
  std::stop_token stop = {};  // gives up early when a stop is requested
};

// Waits for `duration`; false as soon as a stop is requested.
bool Pause(absl::Duration duration, const std::stop_token& stop);

// Runs `attempt` as above.
absl::Status CallWithRetry(const Origin& origin, const RetryOptions& options,
                           const std::function<grpc::Status(grpc::ClientContext*)>& attempt);

// Returns a blocking unary call of an idempotent method (all are: reads by nature, changes by
// request_id):
//   CallUnary(stub, &v1::CatalogService::Stub::GetItem, request, ForwardedFrom(call))
template <class Stub, class Request, class Response>
absl::StatusOr<Response> CallUnary(
    Stub& stub, grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
    const Request& request, const Origin& origin, const RetryOptions& options = {}) {
  Response response;
  absl::Status status = CallWithRetry(origin, options, [&](grpc::ClientContext* context) {
    response.Clear();
    return (stub.*method)(context, request, &response);
  });
  if (!status.ok()) return status;
  return response;
}

// The other services of the house by name, as --peer gave them. Thread safe.
class Peers {
 public:
  Peers(std::map<std::string, std::string> addresses, ChannelSecurity security);
  ~Peers();

  // Returns one channel for each peer, shared. FAILED_PRECONDITION, PEER_UNKNOWN if no --peer named
  // it.
  absl::StatusOr<std::shared_ptr<grpc::Channel>> Channel(const std::string& name);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mortise::rpc
