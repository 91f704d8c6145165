#include "gateway/forwarding/upstreams.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/channel_arguments.h>

#include <atomic>
#include <chrono>
#include <future>

#include "common/base/errors.h"
#include "common/rpc/server_limits.h"
#include "gateway/forwarding/wire.h"

namespace mortise::gateway {
namespace {

// Open at a time on one connection: less than a service takes (rpc::kMaxStreamsOfConnection), for
// a call that is over here may not be there yet.
constexpr int kUsualCalls = rpc::kMaxStreamsOfConnection * 4 / 5;

grpc::ChannelArguments Arguments() {
  grpc::ChannelArguments arguments;
  // Channels with the same arguments would share one connection otherwise.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  // A service that comes back is found within a second.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  // The client decides what is tried again; and without retries nothing needs to be kept for one.
  arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);
  // No service compresses; what is expanded has no limit.
  arguments.SetInt(GRPC_COMPRESSION_CHANNEL_ENABLED_ALGORITHMS_BITSET, 1 << GRPC_COMPRESS_NONE);
  SetFlowControl([&arguments](const char* name, int value) { arguments.SetInt(name, value); });
  return arguments;
}

}  // namespace

// Connections for calls of the same kind.
struct Upstreams::Lane {
  struct Counted {
    Connection connection;
    std::atomic<int> open{0};  // calls
  };

  void Fill(int count, const std::string& address,
            const std::shared_ptr<grpc::ChannelCredentials>& credentials) {
    for (int i = 0; i < count; ++i) {
      auto& counted = *connections.emplace_back(std::make_unique<Counted>());
      counted.connection.channel = grpc::CreateCustomChannel(address, credentials, Arguments());
      counted.connection.stub = std::make_unique<GenericStub>(counted.connection.channel);
    }
  }

  // The first with room, or the one with the fewest calls.
  std::shared_ptr<const Connection> Take(int room) const {
    Counted* fewest = connections.front().get();
    for (const auto& counted : connections) {
      if (counted->open < fewest->open) fewest = counted.get();
      if (fewest->open < room) break;
    }
    ++fewest->open;
    return {&fewest->connection, [fewest](const Connection*) { --fewest->open; }};
  }

  std::vector<std::unique_ptr<Counted>> connections;
};

struct Upstreams::Service {
  Lane calls;
  Lane streams;
  Lane urgent;
};

Upstreams::Upstreams(UpstreamOptions options) : options_(std::move(options)) {}
Upstreams::~Upstreams() = default;

absl::Status Upstreams::Add(const std::string& name, const std::string& address,
                            const rpc::ChannelSecurity& security) {
  if (services_.count(name) != 0) return ResourceExists("service " + name);
  MORTISE_ASSIGN_OR_RETURN(const auto credentials, rpc::MakeClientCredentials(address, security));
  auto service = std::make_unique<Service>();
  service->calls.Fill(options_.channels, address, credentials);
  service->streams.Fill(options_.stream_channels, address, credentials);
  service->urgent.Fill(1, address, credentials);
  services_.emplace(name, std::move(service));
  addresses_.emplace(name, address);
  return absl::OkStatus();
}

std::shared_ptr<const Upstreams::Connection> Upstreams::Take(std::string_view name,
                                                             CallKind kind) const {
  const auto found = services_.find(name);
  if (found == services_.end()) return nullptr;
  const Service& service = *found->second;
  if (kind == CallKind::kCall) return service.calls.Take(0);
  return kind == CallKind::kUrgent ? service.urgent.Take(0) : service.streams.Take(kUsualCalls);
}

int Upstreams::MostOpen(CallKind kind) const {
  if (kind == CallKind::kCall) return kUsualCalls * options_.channels;
  return kind == CallKind::kUrgent ? kUsualCalls : kUsualCalls * options_.stream_channels;
}

std::shared_ptr<grpc::Channel> Upstreams::Channel(std::string_view name) const {
  const auto found = services_.find(name);
  return found == services_.end() ? nullptr
                                  : found->second->calls.connections.front()->connection.channel;
}

bool Upstreams::Healthy(std::string_view name, absl::Duration timeout) const {
  const auto connection = Take(name, CallKind::kCall);
  if (connection == nullptr) return false;
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + absl::ToChronoMilliseconds(timeout));
  const grpc::ByteBuffer request = ToByteBuffer({});  // HealthCheckRequest for the whole server
  grpc::ByteBuffer response;
  std::promise<bool> done;
  connection->stub->UnaryCall(
      &context, "/grpc.health.v1.Health/Check", {}, &request, &response, [&](grpc::Status status) {
        // HealthCheckResponse { status = 1: SERVING } is these two bytes.
        done.set_value(status.ok() && ToString(response) == std::string("\x08\x01"));
      });
  return done.get_future().get();
}

}  // namespace mortise::gateway
