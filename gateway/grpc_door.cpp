#include "gateway/grpc_door.h"

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/impl/server_builder_plugin.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <mutex>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/rpc/server_host.h"
#include "gateway/wire.h"

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

void SetArguments(grpc::ServerBuilder& builder) {
  builder.SetMaxReceiveMessageSize(rpc::kMaxMessageBytes);
  builder.SetOption(std::make_unique<WithoutReflectionPlugin>());
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, 1000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 30000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 10000);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 5000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  SetFlowControl(
      [&builder](const char* name, int value) { builder.AddChannelArgument(name, value); });
}

class Door final : public GrpcDoor {
 public:
  Door(const GrpcDoorOptions& options, const ProxyOptions& proxy)
      : options_(options), proxy_(MakeProxy(proxy)) {}

  ~Door() override { Shutdown(); }

  absl::Status Listen() {
    MORTISE_ASSIGN_OR_RETURN(auto credentials,
                             rpc::MakeServerCredentials(options_.listen, options_.security));
    grpc::EnableDefaultHealthCheckService(true);
    grpc::ServerBuilder builder;
    SetArguments(builder);
    int port = 0;
    builder.AddListeningPort(options_.listen, credentials, &port);
    builder.RegisterCallbackGenericService(proxy_.get());
    server_ = builder.BuildAndStart();
    if (!server_ || port == 0) {
      return WithDetail(
          absl::UnavailableError(absl::StrCat("cannot listen on ", options_.listen,
                                              ": in use, not permitted, or not ours")),
          {"ADDRESS_IN_USE", options_.listen});
    }
    address_ = absl::StrCat(options_.listen.substr(0, options_.listen.rfind(':')), ":", port);
    server_->GetHealthCheckService()->SetServingStatus(false);
    return absl::OkStatus();
  }

  void SetReady() override { server_->GetHealthCheckService()->SetServingStatus(true); }

  void Shutdown() override {
    std::call_once(shut_down_, [this] {
      if (!server_) return;
      server_->GetHealthCheckService()->SetServingStatus(false);
      server_->Shutdown(absl::ToChronoTime(absl::Now() + options_.drain_time));
      server_->Wait();
    });
  }

  const std::string& address() const override { return address_; }

  std::unique_ptr<GenericStub> LocalStub() override {
    return std::make_unique<GenericStub>(server_->InProcessChannel(grpc::ChannelArguments()));
  }

 private:
  const GrpcDoorOptions options_;
  const std::unique_ptr<grpc::CallbackGenericService> proxy_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
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
