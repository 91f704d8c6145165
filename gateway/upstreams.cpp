#include "gateway/upstreams.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/channel_arguments.h>

#include <chrono>
#include <future>

#include "common/base/errors.h"
#include "gateway/wire.h"

namespace mortise::gateway {
namespace {

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
  SetFlowControl([&arguments](const char* name, int value) { arguments.SetInt(name, value); });
  return arguments;
}

}  // namespace

struct Upstreams::Service {
  std::vector<Connection> connections;
  mutable std::atomic<unsigned> next{0};
};

Upstreams::Upstreams(UpstreamOptions options) : options_(std::move(options)) {}
Upstreams::~Upstreams() = default;

absl::Status Upstreams::Add(const std::string& name, const std::string& address,
                            const rpc::ChannelSecurity& security) {
  if (services_.count(name) != 0) return ResourceExists("service " + name);
  MORTISE_ASSIGN_OR_RETURN(const auto credentials, rpc::MakeClientCredentials(address, security));
  auto service = std::make_unique<Service>();
  for (int i = 0; i < options_.channels; ++i) {
    Connection& connection = service->connections.emplace_back();
    connection.channel = grpc::CreateCustomChannel(address, credentials, Arguments());
    connection.stub = std::make_unique<GenericStub>(connection.channel);
  }
  services_.emplace(name, std::move(service));
  addresses_.emplace(name, address);
  return absl::OkStatus();
}

const Upstreams::Connection* Upstreams::Next(std::string_view name) const {
  const auto found = services_.find(name);
  if (found == services_.end()) return nullptr;
  const Service& service = *found->second;
  const unsigned turn = service.next.fetch_add(1, std::memory_order_relaxed);
  return &service.connections[turn % service.connections.size()];
}

std::shared_ptr<grpc::Channel> Upstreams::Channel(std::string_view name) const {
  const auto found = services_.find(name);
  return found == services_.end() ? nullptr : found->second->connections.front().channel;
}

bool Upstreams::Healthy(std::string_view name, absl::Duration timeout) const {
  const Connection* connection = Next(name);
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
