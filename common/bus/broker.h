// The meeting point of the bus: publishers and subscribers connect to it and need not know each
// other. The gateway runs one.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/bus/security.h"

namespace mortise::bus {

struct BrokerOptions {
  // Where publishers and subscribers connect. "tcp://127.0.0.1:*" takes a free port.
  std::string publisher_endpoint = "tcp://127.0.0.1:*";
  std::string subscriber_endpoint = "tcp://127.0.0.1:*";
  BrokerSecurity security = {};
};

// Forwards every message from publishers to the subscribers that asked for its topic, until it is
// destroyed. It keeps nothing: what a slow or absent subscriber misses it fetches from the source.
class Broker {
 public:
  // INVALID_ARGUMENT for bad security options; UNAVAILABLE if an endpoint cannot be bound.
  static absl::StatusOr<std::unique_ptr<Broker>> Start(const BrokerOptions& options);
  virtual ~Broker() = default;

  // The endpoints actually bound, to connect to.
  virtual std::string publisher_endpoint() const = 0;
  virtual std::string subscriber_endpoint() const = 0;
};

}  // namespace mortise::bus
