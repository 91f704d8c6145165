// The main program of a service: flags, store, operations, events, server, signals, end.
//
//   int main(int argc, char** argv) {
//     return mortise::rpc::RunService(argc, argv, {.name = "catalog", .title = "The catalog"},
//                                     mortise::catalog::MakeServices);
//   }
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/host/service_options.h"

namespace grpc {
class Service;
}
namespace prometheus {
class Registry;
}
namespace mortise::store {
class Store;
}
namespace mortise::operations {
class Operations;
}

namespace mortise::rpc {

class Dispatcher;
class IdentitySigner;
class Peers;

// What a service is given to work with. All outlive the services.
struct ServiceEnvironment {
  const ServiceOptions& options;
  store::Store* store;
  operations::Operations* operations;  // register handlers in MakeServices; Start in mutations
  Dispatcher* dispatcher;              // for Endpoint (handler.h)
  Peers* peers;                        // channels to other services
  const IdentitySigner* signer;        // for OwnOrigin (channel.h); null in development
  std::shared_ptr<prometheus::Registry> registry;  // for metrics of the service's own
};

// Makes the gRPC services of the process. OperationService, EventService and AuditService of this
// process are added by RunService. They are destroyed before the environment, after the last call.
using MakeServices =
    std::function<absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>>(ServiceEnvironment&)>;

// Runs until SIGTERM or SIGINT and returns the exit code: 0 after an orderly end; 1 with a message
// on standard error if it could not start (port in use, state folder not writable …); 2 for bad
// flags.
int RunService(int argc, char** argv, const ServiceDescription& description,
               const MakeServices& make_services);

// The same without flags and signals: for tests, and for programs with a main of their own.
class RunningService {
 public:
  static absl::StatusOr<std::unique_ptr<RunningService>> Start(const ServiceOptions& options,
                                                               const MakeServices& make_services);

  // Drains and ends.
  virtual ~RunningService() = default;

  virtual const std::string& address() const = 0;
  virtual const std::string& metrics_address() const = 0;
  virtual ServiceEnvironment& environment() = 0;
};

}  // namespace mortise::rpc
