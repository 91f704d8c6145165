// The meeting point of the bus: publishers and subscribers connect to it and need not know each
// other. The gateway runs one.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/bus/security.h"

namespace mortise::bus {

struct BrokerOptions {
  // Where publishers and subscribers connect. "tcp://127.0.0.1:*" takes a free port.
  std::string publisher_endpoint = "tcp://127.0.0.1:*";
  std::string subscriber_endpoint = "tcp://127.0.0.1:*";
  BrokerSecurity security = {};
  // How long a connection may take to introduce itself as one of ZeroMQ, with its key where keys
  // are asked for, before it is closed.
  absl::Duration handshake_time = absl::Seconds(5);
};

// Forwards every message from publishers to the subscribers that asked for its topic, until it is
// destroyed. It keeps nothing: what a slow or absent subscriber misses it fetches from the source.
//
// ZeroMQ has no limit of connections (ZMQ_MAX_SOCKETS is of sockets that a process makes itself,
// ZMQ_BACKLOG of connections that wait to be accepted), and closes those that it has when an
// endpoint is unbound, so that refusing some for a while is not to be had. What there is: those
// that say nothing are closed after `handshake_time`, those that fall silent by their heartbeat,
// and keys that are not on the list are refused. Who may connect at all is for loopback, where
// there are no keys, and the network to say.
class Broker {
 public:
  // INVALID_ARGUMENT for bad security options; UNAVAILABLE if an endpoint cannot be bound.
  static absl::StatusOr<std::unique_ptr<Broker>> Start(const BrokerOptions& options);
  virtual ~Broker() = default;

  // Returns the endpoints actually bound, to connect to.
  virtual std::string publisher_endpoint() const = 0;
  virtual std::string subscriber_endpoint() const = 0;
};

}  // namespace mortise::bus
