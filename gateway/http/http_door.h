// The HTTP door: Connect calls, server-sent events, the OpenAPI document, health and metrics.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/rpc/channel_security.h"
#include "gateway/http/http_connection.h"

namespace mortise::gateway {

struct HttpContext;

struct HttpDoorOptions {
  std::string listen = "127.0.0.1:0";  // HOST:PORT; port 0 takes a free one
  rpc::ChannelSecurity security;       // certificate and key; none: plain text
  int threads = 2;                     // that serve all connections
  int most_connections = 0;  // at a time; 0: what the process's limit of descriptors leaves
  HttpPatience patience;
};

class HttpDoor {
 public:
  // Listens and serves. UNAVAILABLE, ADDRESS_IN_USE naming the address if it cannot be bound;
  // INVALID_ARGUMENT naming a certificate or key that cannot be used.
  static absl::StatusOr<std::unique_ptr<HttpDoor>> Start(
      const HttpDoorOptions& options, std::shared_ptr<const HttpContext> context);

  // Ends every connection.
  virtual ~HttpDoor() = default;

  // Takes no new connections, blocks until that is so; those that are open are closed after the
  // answer in hand.
  virtual void BeginDrain() = 0;

  // Whether a client that connects now would be served (rpc::ConnectionAcceptor::Probe).
  virtual absl::Status Probe() = 0;

  // Returns the address bound, host:port.
  virtual const std::string& address() const = 0;
};

}  // namespace mortise::gateway
