#include "common/rpc/server_host.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <mutex>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/rpc/connections/connection_acceptor.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/metrics_endpoint.h"

namespace mortise::rpc {
namespace {

// Once all calls are answered: for answers on their way. gRPC itself would wait for idle clients to
// close their connections, which those without a thread of their own notice after five seconds.
constexpr absl::Duration kLastBytes = absl::Milliseconds(200);

absl::Status AddressInUse(const std::string& address) {
  return WithDetail(absl::UnavailableError(absl::StrCat("cannot listen on ", address,
                                                        ": in use, not permitted, or not ours")),
                    {"ADDRESS_IN_USE", address});
}

void PrepareLibrariesOnce() {
  static std::once_flag once;
  std::call_once(once, [] {
    // Debian builds Abseil with its search for deadlocks on. gRPC's own locks then meet in one
    // global graph: about a twentieth of the processor time of a busy server.
    absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
    grpc::EnableDefaultHealthCheckService(true);
    grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  });
}

class Host : public ServerHost {
 public:
  explicit Host(Options options) : options_(std::move(options)) {}

  ~Host() override { Shutdown(); }

  absl::Status Listen() {
    PrepareLibrariesOnce();
    MORTISE_ASSIGN_OR_RETURN(auto credentials,
                             MakeServerCredentials(options_.listen, options_.security));
    if (!options_.metrics.empty()) {
      if (!IsLocalAddress(options_.metrics) && options_.security.certificate.empty()) {
        return InvalidField("metrics", "plain text stays on this machine");
      }
      auto metrics = MetricsEndpoint::Start(options_.metrics, options_.registry);
      if (!metrics.ok()) return AddressInUse(options_.metrics);
      metrics_ = *std::move(metrics);
      metrics_address_ = metrics_->address();
    }
    grpc::ServerBuilder builder;
    SetServerLimits(builder);
    AcceptorOptions acceptor;
    acceptor.listen = options_.listen;
    acceptor.most_connections = options_.most_connections;
    acceptor.take = TakesConnections(builder, credentials);
    // A socket file belongs to this machine's own processes.
    const bool is_file = absl::StartsWith(options_.listen, "unix:");
    if (is_file) builder.AddListeningPort(options_.listen, credentials);
    for (const auto& service : options_.services) builder.RegisterService(service.get());
    if (options_.configure) options_.configure(builder);
    server_ = builder.BuildAndStart();
    if (!server_) return AddressInUse(options_.listen);
    SetHealth(false);
    address_ = options_.listen;
    if (is_file) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(acceptor_, ConnectionAcceptor::Start(std::move(acceptor)));
    address_ = acceptor_->address();
    return absl::OkStatus();
  }

  void SetReady() override { SetHealth(true); }

  void Shutdown() override {
    std::call_once(shut_down_, [this] {
      if (!server_) return;
      Log(LogLevel::kInfo, "draining", {{"address", address_}});
      SetHealth(false);
      absl::Time deadline = absl::Now() + options_.drain_time;
      if (options_.dispatcher) {
        options_.dispatcher->BeginDrain();
        options_.dispatcher->WaitForCalls(deadline);
        deadline = absl::Now() + kLastBytes;
      }
      if (acceptor_) acceptor_->Stop();
      server_->Shutdown(absl::ToChronoTime(deadline));
      server_->Wait();
      Log(LogLevel::kInfo, "stopped", {{"address", address_}});
    });
  }

  const std::string& address() const override { return address_; }
  const std::string& metrics_address() const override { return metrics_address_; }

 private:
  void SetHealth(bool serving) {
    if (auto* health = server_->GetHealthCheckService()) health->SetServingStatus(serving);
  }

  const Options options_;
  std::unique_ptr<MetricsEndpoint> metrics_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<ConnectionAcceptor> acceptor_;
  std::string address_;
  std::string metrics_address_;
  std::once_flag shut_down_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ServerHost>> ServerHost::Start(Options options) {
  auto host = std::make_unique<Host>(std::move(options));
  MORTISE_RETURN_IF_ERROR(host->Listen());
  return host;
}

}  // namespace mortise::rpc
