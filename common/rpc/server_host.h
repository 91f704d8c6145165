// A gRPC server with everything every server of the house has: TLS, health, reflection, message
// limits, keep-alive, an end in phases, and Prometheus metrics.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/rpc/channel_security.h"
#include "common/rpc/server_limits.h"

namespace grpc {
class Server;
class ServerBuilder;
class Service;
}  // namespace grpc
namespace prometheus {
class Registry;
}

namespace mortise::rpc {

class Dispatcher;

class ServerHost {
 public:
  struct Options {
    std::string listen = "127.0.0.1:0";  // HOST:PORT; port 0 takes a free one
    std::string metrics = {};            // HOST:PORT for /metrics; empty for none
    ChannelSecurity security = {};
    int most_connections = 0;  // at a time; 0: what the process's limit of descriptors leaves
    absl::Duration drain_time = absl::Seconds(10);
    Dispatcher* dispatcher = nullptr;                     // told when draining begins; may be null
    std::shared_ptr<prometheus::Registry> registry = {};  // what /metrics shows
    std::vector<std::shared_ptr<grpc::Service>> services = {};
    // Further settings: a generic service, say. Runs before the server is built; may be unset.
    std::function<void(grpc::ServerBuilder&)> configure = nullptr;
  };

  // Listens and serves; health says NOT_SERVING until SetReady. UNAVAILABLE, ADDRESS_IN_USE naming
  // the address if it cannot be bound.
  static absl::StatusOr<std::unique_ptr<ServerHost>> Start(Options options);

  // Ends as Shutdown does.
  virtual ~ServerHost() = default;

  // Health says SERVING, for the whole server and each service.
  virtual void SetReady() = 0;

  // The end in phases: health says NOT_SERVING and waiting calls are asked to answer; no new calls
  // are accepted; those in flight have `drain_time`; what is left is cancelled. Once; blocks.
  virtual void Shutdown() = 0;

  // Returns the addresses actually bound, host:port. Metrics: empty if there are none.
  virtual const std::string& address() const = 0;
  virtual const std::string& metrics_address() const = 0;
};

}  // namespace mortise::rpc
