// The services that the gateway answers itself: what runs, and the lists and streams that bring
// together those of all services. They run behind the proxy like any other service.
#pragma once

#include <memory>
#include <string>

namespace grpc {
class Service;
}
namespace mortise::rpc {
class Dispatcher;
class IdentitySigner;
}  // namespace mortise::rpc
namespace mortise::store {
class Store;
}

namespace mortise::gateway {

class Contract;
class EventHub;
class Upstreams;
class WebhookDelivery;

// What they work with. All outlive the services.
struct HostedEnvironment {
  rpc::Dispatcher* dispatcher = nullptr;
  const Contract* contract = nullptr;
  const Upstreams* upstreams = nullptr;
  EventHub* hub = nullptr;
  store::Store* store = nullptr;
  WebhookDelivery* delivery = nullptr;
  std::string version;
};

// GatewayService: the services, whether they answer, and their methods.
std::shared_ptr<grpc::Service> MakeHouseService(const HostedEnvironment& environment);

// OperationService: ListOperations over all services. Methods that name an operation never come
// here: the proxy sends them to its service.
std::shared_ptr<grpc::Service> MakeMergedOperationService(const HostedEnvironment& environment);

// EventService: the streams there are, and one stream out of many, in order for each.
std::shared_ptr<grpc::Service> MakeMergedEventService(const HostedEnvironment& environment);

// AuditService: the records of all services and of the gateway itself.
std::shared_ptr<grpc::Service> MakeMergedAuditService(const HostedEnvironment& environment);

// WebhookService: subscriptions and what could not be delivered.
std::shared_ptr<grpc::Service> MakeWebhookService(const HostedEnvironment& environment);

}  // namespace mortise::gateway
