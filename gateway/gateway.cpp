#include "gateway/gateway.h"

#include <grpcpp/channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/descriptor_limit.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/logging.h"
#include "common/bus/broker.h"
#include "common/bus/key_folder.h"
#include "common/rpc/channel.h"
#include "common/rpc/connections/connection_acceptor.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/identity.h"
#include "common/rpc/server_host.h"
#include "common/store/store.h"
#include "gateway/admission/budget.h"
#include "gateway/contract/contract.h"
#include "gateway/contract/openapi.h"
#include "gateway/contract/transcoder.h"
#include "gateway/door_health.h"
#include "gateway/forwarding/call_log.h"
#include "gateway/forwarding/event_codec.h"
#include "gateway/forwarding/event_hub.h"
#include "gateway/forwarding/grpc_door.h"
#include "gateway/forwarding/hosted_services.h"
#include "gateway/forwarding/upstreams.h"
#include "gateway/http/http_context.h"
#include "gateway/http/http_door.h"
#include "mortise/v1/events.grpc.pb.h"

namespace mortise::gateway {
namespace {

constexpr char kName[] = "gateway";
// Who connects to the services that the gateway hosts is the gateway alone.
constexpr int kOwnConnections = 64;
constexpr absl::Duration kEventCallTime = absl::Seconds(10);

absl::Status CheckOptions(const GatewayOptions& options, const Contract& contract) {
  for (const auto& [name, address] : options.services) {
    const auto& known = contract.services();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return InvalidField("service", absl::StrCat("the protos know no service '", name, "'"));
    }
  }
  const bool local = rpc::IsLocalAddress(options.grpc) && rpc::IsLocalAddress(options.http);
  if (options.insecure_development && !local) {
    return InvalidField("insecure-development", "is for doors on loopback only");
  }
  const bool knows_keys = !options.jwt_keys.empty() || !options.jwks.url.empty();
  if (!options.insecure_development && (options.keys.empty() || !knows_keys)) {
    return InvalidField(options.keys.empty() ? "keys" : "jwt-keys",
                        options.keys.empty()
                            ? "is needed unless --insecure-development is given"
                            : "or --jwks-url is needed unless --insecure-development is given");
  }
  if (options.security.certificate.empty() != options.security.key.empty()) {
    return InvalidField("tls-key", "a certificate and its key come together");
  }
  if (options.security.certificate.empty() && !local) {
    return InvalidField("tls-certificate", "is needed: plain text stays on this machine");
  }
  return absl::OkStatus();
}

// Members are in the order of their making.
class House final : public Gateway {
 public:
  explicit House(const GatewayOptions& options) : options_(options) {}

  ~House() override { Stop(); }

  absl::Status Begin() {
    MORTISE_RETURN_IF_ERROR(CheckOptions(options_, *contract_));
    MORTISE_RETURN_IF_ERROR(LoadKeys());
    MORTISE_ASSIGN_OR_RETURN(store_, store::OpenStore({.url = options_.store, .service = kName}));
    MORTISE_ASSIGN_OR_RETURN(bus::BrokerSecurity broker_security,
                             bus::LoadBrokerSecurity(options_.keys, kName));
    MORTISE_ASSIGN_OR_RETURN(bus_security_, bus::LoadClientSecurity(options_.keys, kName, kName));
    MORTISE_ASSIGN_OR_RETURN(broker_,
                             bus::Broker::Start({.publisher_endpoint = options_.bus_publish,
                                                 .subscriber_endpoint = options_.bus_subscribe,
                                                 .security = std::move(broker_security)}));
    StartEvents();
    MORTISE_ASSIGN_OR_RETURN(delivery_,
                             WebhookDelivery::Start(options_.webhooks, store_.get(), hub_.get(),
                                                    contract_.get(), &transcoder_));
    UpstreamOptions upstreams;
    upstreams.channels = options_.channels;
    upstreams.patience = options_.patience;
    upstreams_ = std::make_unique<Upstreams>(upstreams);
    MORTISE_RETURN_IF_ERROR(StartHostedServices());
    for (const auto& [name, address] : options_.services) {
      MORTISE_RETURN_IF_ERROR(upstreams_->Add(name, address, options_.services_security));
    }
    MORTISE_RETURN_IF_ERROR(upstreams_->Add(kName, host_->address(), {}));
    MORTISE_RETURN_IF_ERROR(OpenDoors());
    addresses_ = {grpc_door_->address(), http_door_->address(), broker_->publisher_endpoint(),
                  broker_->subscriber_endpoint()};
    host_->SetReady();
    grpc_door_->SetReady();
    serving_ = true;
    health_.Begin({[this] { return grpc_door_->Probe(); }, [this] { return http_door_->Probe(); }});
    return WritePortFile();
  }

  const GatewayAddresses& addresses() const override { return addresses_; }

 private:
  absl::Status LoadKeys() {
    AdmissionOptions admission;
    admission.insecure_development = options_.insecure_development;
    admission.token = options_.token;
    MORTISE_RETURN_IF_ERROR(LoadTokenKeys());
    admission.keys = token_keys_.get();
    // In development callers need no token, but services verify what the gateway says of them
    // wherever keys are given.
    if (!options_.keys.empty()) {
      MORTISE_ASSIGN_OR_RETURN(signer_, rpc::IdentitySigner::Load(options_.keys, kName));
      MORTISE_ASSIGN_OR_RETURN(verifier_, rpc::IdentityVerifier::Load({.folder = options_.keys}));
    }
    admission.signer = signer_.get();
    admission_ = std::make_unique<Admission>(std::move(admission));
    return absl::OkStatus();
  }

  // Of the file, the address, or both.
  absl::Status LoadTokenKeys() {
    std::optional<TokenKeys> of_file;
    if (!options_.jwt_keys.empty()) {
      MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(options_.jwt_keys, 1 << 20));
      MORTISE_ASSIGN_OR_RETURN(of_file, TokenKeys::Parse(text));
    }
    if (!options_.jwks.url.empty()) {
      KeyAddressOptions address = options_.jwks;
      address.also = of_file;
      MORTISE_ASSIGN_OR_RETURN(token_keys_, KeyAddress::Start(address));
    } else if (of_file) {
      token_keys_ = std::make_unique<FixedKeys>(*std::move(of_file));
    }
    return absl::OkStatus();
  }

  rpc::Origin OwnOrigin() const {
    return rpc::OwnOrigin(signer_.get(), rpc::Role::kViewer, "", kEventCallTime);
  }

  // Events are asked for over channels of their own, apart from those of clients' calls.
  void StartEvents() {
    peers_ = std::make_unique<rpc::Peers>(options_.services, options_.services_security);
    EventHubOptions hub;
    hub.endpoint = broker_->subscriber_endpoint();
    hub.security = bus_security_;
    for (const auto& [name, address] : options_.services) hub.streams.push_back(name);
    hub.fetch = [this](const std::string& stream, int64_t after, int limit) {
      return FetchEvents(stream, after, limit);
    };
    hub.latest = [this](const std::string& stream) { return LatestEvent(stream); };
    hub_ = EventHub::Start(std::move(hub));
  }

  absl::StatusOr<v1::ReadEventsResponse> ReadEvents(const std::string& stream, int64_t after,
                                                    int limit) const {
    MORTISE_ASSIGN_OR_RETURN(const auto channel, peers_->Channel(stream));
    v1::EventService::Stub stub(channel);
    v1::ReadEventsRequest request;
    request.set_stream(stream);
    request.set_after_number(after);
    request.set_limit(limit);
    rpc::RetryOptions once;
    once.patience = absl::ZeroDuration();
    return rpc::CallUnary<v1::EventService::Stub, v1::ReadEventsRequest, v1::ReadEventsResponse>(
        stub, &v1::EventService::Stub::ReadEvents, request, OwnOrigin(), once);
  }

  absl::StatusOr<std::vector<bus::Event>> FetchEvents(const std::string& stream, int64_t after,
                                                      int limit) const {
    MORTISE_ASSIGN_OR_RETURN(const v1::ReadEventsResponse response,
                             ReadEvents(stream, after, limit));
    std::vector<bus::Event> events;
    for (const v1::Event& event : response.events()) events.push_back(FromProto(event));
    return events;
  }

  absl::StatusOr<int64_t> LatestEvent(const std::string& stream) const {
    MORTISE_ASSIGN_OR_RETURN(const v1::ReadEventsResponse response, ReadEvents(stream, 0, 1));
    return response.latest_number();
  }

  absl::Status StartHostedServices() {
    dispatcher_ = rpc::Dispatcher::Create({.service = kName,
                                           .store = store_.get(),
                                           .verifier = verifier_.get(),
                                           .registry = registry_});
    HostedEnvironment environment;
    environment.dispatcher = dispatcher_.get();
    environment.contract = contract_.get();
    environment.upstreams = upstreams_.get();
    environment.hub = hub_.get();
    environment.store = store_.get();
    environment.delivery = delivery_.get();
    environment.version = GatewayVersion();
    rpc::ServerHost::Options host;
    host.dispatcher = dispatcher_.get();
    host.most_connections = kOwnConnections;
    host.services = {MakeHouseService(environment), MakeMergedOperationService(environment),
                     MakeMergedEventService(environment), MakeMergedAuditService(environment),
                     MakeWebhookService(environment)};
    MORTISE_ASSIGN_OR_RETURN(host_, rpc::ServerHost::Start(std::move(host)));
    return absl::OkStatus();
  }

  absl::Status OpenDoors() {
    call_log_ = std::make_unique<CallLog>(*contract_, *registry_, options_.log_calls);
    ProxyOptions proxy;
    proxy.contract = contract_.get();
    proxy.upstreams = upstreams_.get();
    proxy.admission = admission_.get();
    open_calls_ = std::make_unique<OpenCalls>(CallLimits());
    proxy.open_calls = open_calls_.get();
    bodies_ = std::make_unique<Budget>(options_.body_bytes, options_.body_bytes / 4);
    proxy.bodies = bodies_.get();
    proxy.reflection_time = options_.reflection_time;
    proxy.log = call_log_.get();
    GrpcDoorOptions grpc;
    grpc.listen = options_.grpc;
    grpc.security = options_.security;
    grpc.drain_time = options_.drain_time;
    grpc.most_connections = ConnectionsOfDoor();
    MORTISE_ASSIGN_OR_RETURN(grpc_door_, GrpcDoor::Start(grpc, proxy));
    return OpenHttpDoor();
  }

  // Both doors together leave the process what it needs itself.
  int ConnectionsOfDoor() const {
    if (options_.most_connections > 0) return options_.most_connections;
    return std::min(rpc::kMaxConnections, ConnectionsWithin(DescriptorLimit()) / 2);
  }

  OpenCallLimits CallLimits() const {
    OpenCallLimits limits = options_.open_calls;
    const auto carried = [&](CallKind kind) { return upstreams_->MostOpen(kind); };
    const auto cut = [](OpenCallLimits::Limit& limit, int most) {
      limit.of_service = std::min(limit.of_service, most);
    };
    cut(limits.calls, carried(CallKind::kCall));
    cut(limits.waits, carried(CallKind::kWait) / 2);
    cut(limits.streams, carried(CallKind::kStream) / 2);
    cut(limits.urgent, carried(CallKind::kUrgent));
    return limits;
  }

  absl::Status OpenHttpDoor() {
    // Half of the door's connections stay free for calls, whatever streams there are.
    const int answers = std::max(1, ConnectionsOfDoor() / 2);
    answers_ = std::make_unique<Budget>(answers, std::max(1, answers / 2));
    local_stub_ = grpc_door_->LocalStub();
    auto context = std::make_shared<HttpContext>();
    context->contract = contract_.get();
    context->transcoder = &transcoder_;
    context->admission = admission_.get();
    context->stub = local_stub_.get();
    context->version = GatewayVersion();
    context->openapi = OpenApiDocument(*contract_, context->version);
    context->metrics = [registry = registry_] {
      return prometheus::TextSerializer().Serialize(registry->Collect());
    };
    context->open_calls = open_calls_.get();
    context->bodies = bodies_.get();
    context->answers = answers_.get();
    MORTISE_ASSIGN_OR_RETURN(context->cross_origins, CrossOrigins::Parse(options_.cors_origins));
    context->loopback_names_only = options_.insecure_development;
    context->health = [this] {
      return serving_ ? health_.Now() : absl::UnavailableError("draining");
    };
    HttpDoorOptions http;
    http.listen = options_.http;
    http.security = options_.security;
    http.threads = options_.http_threads;
    http.most_connections = ConnectionsOfDoor();
    http.patience = options_.http_patience;
    MORTISE_ASSIGN_OR_RETURN(http_door_, HttpDoor::Start(http, std::move(context)));
    return absl::OkStatus();
  }

  absl::Status WritePortFile() const {
    if (options_.port_file.empty()) return absl::OkStatus();
    const nlohmann::json json = {{"grpc", addresses_.grpc},
                                 {"http", addresses_.http},
                                 {"bus_publish", addresses_.bus_publish},
                                 {"bus_subscribe", addresses_.bus_subscribe}};
    return WriteFile(options_.port_file, json.dump() + "\n");
  }

  // Nothing new comes in; endless streams end; calls in hand have their time; then all is closed.
  void Stop() {
    serving_ = false;
    health_.End();
    if (http_door_) http_door_->BeginDrain();
    if (dispatcher_) dispatcher_->BeginDrain();
    if (grpc_door_) grpc_door_->Shutdown();
    http_door_.reset();
    local_stub_.reset();
    grpc_door_.reset();
    if (host_) host_->Shutdown();
    delivery_.reset();
    hub_.reset();
    host_.reset();
  }

  const GatewayOptions options_;
  const std::shared_ptr<prometheus::Registry> registry_ = std::make_shared<prometheus::Registry>();
  const std::unique_ptr<const Contract> contract_ = Contract::Load();
  const Transcoder transcoder_{*contract_};
  std::unique_ptr<rpc::IdentitySigner> signer_;
  std::unique_ptr<rpc::IdentityVerifier> verifier_;
  std::unique_ptr<KeySource> token_keys_;
  std::unique_ptr<Admission> admission_;
  std::unique_ptr<store::Store> store_;
  bus::ClientSecurity bus_security_;
  std::unique_ptr<bus::Broker> broker_;
  std::unique_ptr<rpc::Peers> peers_;
  std::unique_ptr<EventHub> hub_;
  std::unique_ptr<WebhookDelivery> delivery_;
  std::unique_ptr<Upstreams> upstreams_;
  std::unique_ptr<rpc::Dispatcher> dispatcher_;
  std::unique_ptr<rpc::ServerHost> host_;
  std::unique_ptr<CallLog> call_log_;
  std::unique_ptr<OpenCalls> open_calls_;
  std::unique_ptr<Budget> answers_;
  std::unique_ptr<Budget> bodies_;
  DoorHealth health_;
  std::unique_ptr<GrpcDoor> grpc_door_;
  std::unique_ptr<GenericStub> local_stub_;
  std::unique_ptr<HttpDoor> http_door_;
  std::atomic<bool> serving_{false};
  GatewayAddresses addresses_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Gateway>> Gateway::Start(const GatewayOptions& options) {
  auto house = std::make_unique<House>(options);
  MORTISE_RETURN_IF_ERROR(house->Begin());
  return std::unique_ptr<Gateway>(std::move(house));
}

const char* GatewayVersion() { return MORTISE_VERSION; }

}  // namespace mortise::gateway
