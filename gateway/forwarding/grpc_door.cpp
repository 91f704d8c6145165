#include "gateway/forwarding/grpc_door.h"

#include <grpcpp/ext/health_check_service_server_builder_option.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/impl/server_builder_plugin.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <mutex>

#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/rpc/connections/connection_acceptor.h"
#include "common/rpc/server_limits.h"
#include "gateway/admission/strangers.h"
#include "gateway/forwarding/health_answers.h"
#include "gateway/forwarding/wire.h"

namespace mortise::gateway {
namespace {

// The process-wide reflection plugin lists the services registered with a server, and here there
// are none: the proxy answers reflection for all.
class WithoutReflectionPlugin final : public grpc::ServerBuilderOption {
 public:
  void UpdateArguments(grpc::ChannelArguments*) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    plugins->erase(std::remove_if(plugins->begin(), plugins->end(),
                                  [](const std::unique_ptr<grpc::ServerBuilderPlugin>& plugin) {
                                    return plugin->name() == "proto_server_reflection";
                                  }),
                   plugins->end());
  }
};

// Memory that the connections of all clients may take for what has not been passed on yet: when it
// runs short, gRPC takes less from each, and ends some that are idle.
constexpr std::size_t kMaxBytesUnderWay = 512 << 20;

// Tokens may be long, and what is too much is refused with words by the proxy.
constexpr int kMaxMetadataBytes = 64 * 1024;

// A client whose connection is closed because it made no calls makes a new one for the next.
constexpr int kIdleMilliseconds = 10 * 60 * 1000;

void SetArguments(grpc::ServerBuilder& builder) {
  rpc::SetServerLimits(builder, kMaxMetadataBytes);
  builder.SetOption(std::make_unique<WithoutReflectionPlugin>());
  // Nor gRPC's own health service, which would take its calls from the proxy.
  builder.SetOption(std::make_unique<grpc::HealthCheckServiceServerBuilderOption>(nullptr));
  // The proxy expands what is compressed with gzip; gRPC itself, nothing (rpc::SetServerLimits).
  builder.SetCompressionAlgorithmSupportStatus(GRPC_COMPRESS_GZIP, true);
  grpc::ResourceQuota memory("grpc-door");
  memory.Resize(kMaxBytesUnderWay);
  builder.SetResourceQuota(memory);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kIdleMilliseconds);
  SetFlowControl(
      [&builder](const char* name, int value) { builder.AddChannelArgument(name, value); });
}

class Door final : public GrpcDoor {
 public:
  Door(const GrpcDoorOptions& options, const ProxyOptions& proxy)
      : options_(options), proxy_(MakeProxy(WithOwn(proxy))) {}

  ~Door() override { Shutdown(); }

  absl::Status Listen() {
    MORTISE_ASSIGN_OR_RETURN(auto credentials,
                             rpc::MakeServerCredentials(options_.listen, options_.security));
    grpc::ServerBuilder builder;
    SetArguments(builder);
    rpc::AcceptorOptions acceptor;
    acceptor.listen = options_.listen;
    acceptor.most_connections = options_.most_connections;
    acceptor.shares_places = true;
    acceptor.take = [this, give = rpc::TakesConnections(builder, credentials)](int descriptor) {
      strangers_.Enter(descriptor);
      give(descriptor);
    };
    acceptor.has_idle = [this] { return strangers_.Any(); };
    acceptor.close_idle = [this] { return strangers_.CloseLongest(); };
    builder.RegisterCallbackGenericService(proxy_.get());
    server_ = builder.BuildAndStart();
    if (!server_) return absl::InternalError("gRPC could not start a server");
    MORTISE_ASSIGN_OR_RETURN(acceptor_, rpc::ConnectionAcceptor::Start(std::move(acceptor)));
    return absl::OkStatus();
  }

  void SetReady() override { health_.SetServing(); }

  absl::Status Probe() override { return acceptor_->Probe(); }

  void Shutdown() override {
    std::call_once(shut_down_, [this] {
      if (acceptor_) acceptor_->Stop();
      if (!server_) return;
      health_.End();
      server_->Shutdown(absl::ToChronoTime(absl::Now() + options_.drain_time));
      server_->Wait();
    });
  }

  const std::string& address() const override { return acceptor_->address(); }

  std::unique_ptr<GenericStub> LocalStub() override {
    return std::make_unique<GenericStub>(server_->InProcessChannel(grpc::ChannelArguments()));
  }

 private:
  ProxyOptions WithOwn(ProxyOptions proxy) {
    proxy.health = &health_;
    proxy.strangers = &strangers_;
    return proxy;
  }

  const GrpcDoorOptions options_;
  HealthAnswers health_;
  Strangers strangers_;
  const std::unique_ptr<grpc::CallbackGenericService> proxy_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<rpc::ConnectionAcceptor> acceptor_;
  std::once_flag shut_down_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<GrpcDoor>> GrpcDoor::Start(const GrpcDoorOptions& options,
                                                          const ProxyOptions& proxy) {
  auto door = std::make_unique<Door>(options, proxy);
  MORTISE_RETURN_IF_ERROR(door->Listen());
  return std::unique_ptr<GrpcDoor>(std::move(door));
}

}  // namespace mortise::gateway
