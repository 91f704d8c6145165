#include "common/host/run_service.h"

#include <grpcpp/impl/service_type.h>
#include <prometheus/registry.h>
#include <signal.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/descriptor_limit.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/logging.h"
#include "common/bus/key_folder.h"
#include "common/bus/outbox_relay.h"
#include "common/bus/publisher.h"
#include "common/host/audit_service.h"
#include "common/host/event_service.h"
#include "common/host/operation_service.h"
#include "common/operations/operations.h"
#include "common/rpc/channel.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/identity.h"
#include "common/rpc/mutation_log.h"
#include "common/rpc/server_host.h"
#include "common/store/store.h"

namespace mortise::rpc {
namespace {

constexpr absl::Duration kForgetInterval = absl::Hours(6);

// Passes events on to the bus, where there is one, and wakes followers of the event service.
class SignallingPublisher : public bus::Publisher {
 public:
  SignallingPublisher(std::unique_ptr<bus::Publisher> bus, std::shared_ptr<EventSignal> signal)
      : bus_(std::move(bus)), signal_(std::move(signal)) {}

  absl::Status Publish(const bus::Event& event) override {
    signal_->Notify();
    return bus_ ? bus_->Publish(event) : absl::OkStatus();
  }

  absl::Status Publish(const bus::Heartbeat& heartbeat) override {
    return bus_ ? bus_->Publish(heartbeat) : absl::OkStatus();
  }

 private:
  const std::unique_ptr<bus::Publisher> bus_;
  const std::shared_ptr<EventSignal> signal_;
};

// Members are in the order of their making; Stop takes down what must go in another order.
class Service : public RunningService {
 public:
  explicit Service(const ServiceOptions& options) : options_(options) {}

  ~Service() override { Stop(); }

  absl::Status Begin(const MakeServices& make_services) {
    MORTISE_RETURN_IF_ERROR(LoadKeys());
    MORTISE_RETURN_IF_ERROR(OpenStoreAndBus());
    dispatcher_ = Dispatcher::Create({.service = options_.name,
                                      .threads = options_.threads,
                                      .store = store_.get(),
                                      .verifier = verifier_.get(),
                                      .registry = registry_});
    peers_ = std::make_unique<Peers>(options_.peers, options_.security);
    MORTISE_ASSIGN_OR_RETURN(operations_,
                             operations::Operations::Create({.service = options_.name,
                                                             .owner = options_.replica,
                                                             .threads = options_.operation_threads},
                                                            store_.get()));
    environment_.reset(new ServiceEnvironment{options_, store_.get(), operations_.get(),
                                              dispatcher_.get(), peers_.get(), signer_.get(),
                                              registry_});
    MORTISE_ASSIGN_OR_RETURN(services_, make_services(*environment_));
    MORTISE_RETURN_IF_ERROR(Serve());
    MORTISE_RETURN_IF_ERROR(operations_->Resume());
    host_->SetReady();
    ForgetRepeatedly();
    return WritePortFile();
  }

  const std::string& address() const override { return host_->address(); }
  const std::string& metrics_address() const override { return host_->metrics_address(); }
  ServiceEnvironment& environment() override { return *environment_; }

 private:
  absl::Status LoadKeys() {
    if (options_.insecure_development) {
      if (IsLocalAddress(options_.listen)) return absl::OkStatus();
      return InvalidField("insecure-development", "is for loopback only");
    }
    MORTISE_ASSIGN_OR_RETURN(verifier_, IdentityVerifier::Load({.folder = options_.keys}));
    MORTISE_ASSIGN_OR_RETURN(signer_, IdentitySigner::Load(options_.keys, options_.name));
    return absl::OkStatus();
  }

  absl::Status OpenStoreAndBus() {
    MORTISE_ASSIGN_OR_RETURN(store_, store::OpenStore({.url = options_.store,
                                                       .blob_folder = options_.blobs,
                                                       .service = options_.name}));
    std::unique_ptr<bus::Publisher> bus;
    if (!options_.bus_publish.empty()) {
      MORTISE_ASSIGN_OR_RETURN(
          bus::ClientSecurity security,
          bus::LoadClientSecurity(options_.keys, options_.name, kGatewayIssuer));
      MORTISE_ASSIGN_OR_RETURN(bus, bus::Publisher::Connect({.endpoint = options_.bus_publish,
                                                             .security = std::move(security)}));
    }
    publisher_ = std::make_unique<SignallingPublisher>(std::move(bus), signal_);
    relay_ = bus::OutboxRelay::Start({.stream = options_.name}, store_.get(), publisher_.get());
    return absl::OkStatus();
  }

  absl::Status Serve() {
    services_.push_back(MakeOperationService(dispatcher_.get(), operations_.get()));
    services_.push_back(MakeEventService(dispatcher_.get(), store_.get(), options_.name, signal_));
    services_.push_back(MakeAuditService(dispatcher_.get(), store_.get(), options_.name));
    MORTISE_ASSIGN_OR_RETURN(host_, ServerHost::Start({.listen = options_.listen,
                                                       .metrics = options_.metrics,
                                                       .security = options_.security,
                                                       .drain_time = options_.drain_time,
                                                       .dispatcher = dispatcher_.get(),
                                                       .registry = registry_,
                                                       .services = services_}));
    Log(LogLevel::kInfo, "serving", {{"address", host_->address()}});
    return absl::OkStatus();
  }

  absl::Status WritePortFile() const {
    if (options_.port_file.empty()) return absl::OkStatus();
    const nlohmann::json json = {{"grpc", host_->address()}, {"metrics", host_->metrics_address()}};
    return WriteFile(options_.port_file, json.dump() + "\n");
  }

  void ForgetRepeatedly() {
    dispatcher_->Submit([this] {
      const absl::StatusOr<int> forgotten = ForgetOldAnswers(*store_);
      if (!forgotten.ok()) {
        Log(LogLevel::kWarning, "old answers are kept", {{"error", forgotten.status().message()}});
      }
      dispatcher_->SubmitAfter(kForgetInterval, [this] { ForgetRepeatedly(); });
    });
  }

  // Calls end first; then operations, whose handlers use the services; then the services.
  void Stop() {
    if (host_) host_->Shutdown();
    if (dispatcher_) dispatcher_->WaitIdle();
    operations_.reset();
    if (dispatcher_) dispatcher_->WaitIdle();
    host_.reset();
    services_.clear();
  }

  const ServiceOptions options_;
  const std::shared_ptr<prometheus::Registry> registry_ = std::make_shared<prometheus::Registry>();
  const std::shared_ptr<EventSignal> signal_ = EventSignal::Create();
  std::unique_ptr<IdentityVerifier> verifier_;
  std::unique_ptr<IdentitySigner> signer_;
  std::unique_ptr<store::Store> store_;
  std::unique_ptr<bus::Publisher> publisher_;
  std::unique_ptr<bus::OutboxRelay> relay_;
  std::unique_ptr<Dispatcher> dispatcher_;
  std::unique_ptr<Peers> peers_;
  std::unique_ptr<operations::Operations> operations_;
  std::unique_ptr<ServiceEnvironment> environment_;
  std::vector<std::shared_ptr<grpc::Service>> services_;
  std::unique_ptr<ServerHost> host_;
};

// The thread that waits for signals; a handler has nothing but globals to find it by.
pthread_t waiting_thread;

void HandOver(int signal) { pthread_kill(waiting_thread, signal); }

// Has this thread wait for the signals that end a service. They are blocked in it, and in all that
// it starts. Libraries have started threads before main(), as OpenBLAS does, in which they are not:
// what these are given, as they may be until this one waits, would end the process at once.
sigset_t TakeEndingSignals() {
  waiting_thread = pthread_self();
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  struct sigaction action = {};
  action.sa_handler = HandOver;
  action.sa_flags = SA_RESTART;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  return signals;
}

int Fail(const std::string& service, const absl::Status& status, int code) {
  std::fprintf(stderr, "mortise-%s: %s\n", service.c_str(), std::string(status.message()).c_str());
  return code;
}

}  // namespace

absl::StatusOr<std::unique_ptr<RunningService>> RunningService::Start(
    const ServiceOptions& options, const MakeServices& make_services) {
  auto service = std::make_unique<Service>(options);
  MORTISE_RETURN_IF_ERROR(service->Begin(make_services));
  return service;
}

int RunService(int argc, char** argv, const ServiceDescription& description,
               const MakeServices& make_services) {
  const absl::StatusOr<ServiceOptions> options = ParseServiceOptions(argc, argv, description);
  if (absl::IsCancelled(options.status())) {
    std::fputs(std::string(options.status().message()).c_str(), stdout);
    return 0;
  }
  if (!options.ok()) return Fail(description.name, options.status(), 2);
  ConfigureLogging(options->name, options->log_level);

  const sigset_t signals = TakeEndingSignals();
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);  // who writes is told that a file may not grow further
  RaiseDescriptorLimit();

  absl::StatusOr<std::unique_ptr<RunningService>> running =
      RunningService::Start(*options, make_services);
  if (!running.ok()) return Fail(description.name, running.status(), 1);
  int caught = 0;
  sigwait(&signals, &caught);
  Log(LogLevel::kInfo, "asked to end", {{"signal", caught}});
  running->reset();
  return 0;
}

}  // namespace mortise::rpc
