// The gRPC door: one server whose every method goes through the proxy, with health and reflection.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/rpc/channel_security.h"
#include "gateway/forwarding/proxy.h"

namespace mortise::gateway {

struct GrpcDoorOptions {
  std::string listen = "127.0.0.1:0";  // HOST:PORT; port 0 takes a free one
  rpc::ChannelSecurity security;       // certificate and key; none: plain text, on loopback only
  absl::Duration drain_time = absl::Seconds(10);
  int most_connections = 0;  // at a time; 0: what the process's limit of descriptors leaves
};

class GrpcDoor {
 public:
  // Listens and serves; health says NOT_SERVING until SetReady. UNAVAILABLE, ADDRESS_IN_USE naming
  // the address if it cannot be bound.
  static absl::StatusOr<std::unique_ptr<GrpcDoor>> Start(const GrpcDoorOptions& options,
                                                         const ProxyOptions& proxy);

  // Ends as Shutdown does.
  virtual ~GrpcDoor() = default;

  virtual void SetReady() = 0;

  // Whether a client that connects now would be served (rpc::ConnectionAcceptor::Probe).
  virtual absl::Status Probe() = 0;

  // Health says NOT_SERVING, new calls are refused, those in flight have `drain_time`, what is left
  // is cancelled. Once; blocks.
  virtual void Shutdown() = 0;

  virtual const std::string& address() const = 0;

  // Calls this door from within the process: the same admission, routes and log as from outside.
  virtual std::unique_ptr<GenericStub> LocalStub() = 0;
};

}  // namespace mortise::gateway
