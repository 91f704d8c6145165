#include "common/rpc/channel.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <random>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/rpc/connection_arguments.h"
#include "common/rpc/status_mapping.h"

namespace mortise::rpc {
namespace {

// Half to all of `delay`, so that many callers do not come back at once.
absl::Duration Jittered(absl::Duration delay) {
  thread_local std::minstd_rand random(std::random_device{}());
  return delay * std::uniform_real_distribution<double>(0.5, 1.0)(random);
}

}  // namespace

bool Pause(absl::Duration duration, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  return !stopped.wait_for(lock, stop, absl::ToChronoNanoseconds(duration),
                           [&] { return stop.stop_requested(); });
}

absl::StatusOr<std::shared_ptr<grpc::Channel>> MakeChannel(const std::string& address,
                                                           const ChannelSecurity& security) {
  MORTISE_ASSIGN_OR_RETURN(auto credentials, MakeClientCredentials(address, security));
  return grpc::CreateCustomChannel(address, credentials, ConnectionArguments());
}

Origin ForwardedFrom(const Call& call) {
  Origin origin;
  origin.trace_id = call.identity().trace_id;
  origin.deadline = call.deadline();
  if (!call.signed_identity().empty()) {
    origin.identity = [identity = call.signed_identity()] { return identity; };
  }
  return origin;
}

Origin OwnOrigin(const IdentitySigner* signer, Role role, std::string trace_id,
                 absl::Duration timeout) {
  Origin origin;
  origin.deadline = absl::Now() + timeout;
  if (signer != nullptr) {
    origin.identity = [signer, role, trace_id] { return signer->SignService(role, trace_id); };
  }
  origin.trace_id = std::move(trace_id);
  return origin;
}

std::unique_ptr<grpc::ClientContext> MakeClientContext(const Origin& origin) {
  auto context = std::make_unique<grpc::ClientContext>();
  if (origin.identity) context->AddMetadata(kIdentityMetadata, origin.identity());
  if (!origin.trace_id.empty()) context->AddMetadata(kTraceMetadata, origin.trace_id);
  if (origin.deadline != absl::InfiniteFuture()) {
    context->set_deadline(absl::ToChronoTime(origin.deadline));
  }
  return context;
}

absl::Status CallWithRetry(const Origin& origin, const RetryOptions& options,
                           const std::function<grpc::Status(grpc::ClientContext*)>& attempt) {
  const absl::Time end = std::min(origin.deadline, absl::Now() + options.patience);
  absl::Duration delay = options.first_delay;
  while (true) {
    const std::unique_ptr<grpc::ClientContext> context = MakeClientContext(origin);
    absl::Status status = FromGrpc(attempt(context.get()));
    const absl::Duration pause = Jittered(delay);
    if (!absl::IsUnavailable(status) || absl::Now() + pause >= end || !Pause(pause, options.stop)) {
      return status;
    }
    delay = std::min(delay * 2, options.longest_delay);
  }
}

struct Peers::State {
  std::map<std::string, std::string> addresses;
  ChannelSecurity security;
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<grpc::Channel>> channels;  // guarded by mutex
};

Peers::Peers(std::map<std::string, std::string> addresses, ChannelSecurity security)
    : state_(std::make_unique<State>()) {
  state_->addresses = std::move(addresses);
  state_->security = std::move(security);
}

Peers::~Peers() = default;

absl::StatusOr<std::shared_ptr<grpc::Channel>> Peers::Channel(const std::string& name) {
  std::lock_guard lock(state_->mutex);
  std::shared_ptr<grpc::Channel>& channel = state_->channels[name];
  if (channel) return channel;
  const auto address = state_->addresses.find(name);
  if (address == state_->addresses.end()) {
    return PreconditionFailed(
        "PEER_UNKNOWN",
        absl::StrCat("where '", name, "' is was not said: --peer ", name, "=HOST:PORT"), name);
  }
  MORTISE_ASSIGN_OR_RETURN(channel, MakeChannel(address->second, state_->security));
  return channel;
}

}  // namespace mortise::rpc
