// Sends events and heartbeats to the broker.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/bus/event.h"
#include "common/bus/security.h"

namespace mortise::bus {

struct PublisherOptions {
  std::string endpoint = {};  // the broker's publisher endpoint
  ClientSecurity security = {};
  int queue_length = 100000;  // messages held while the broker is slow; more are dropped
};

// Thread safe. Sending never blocks: without a broker, or with a full queue, messages are dropped,
// and subscribers fetch them later by number. Connects and reconnects by itself.
class Publisher {
 public:
  static absl::StatusOr<std::unique_ptr<Publisher>> Connect(const PublisherOptions& options);
  virtual ~Publisher() = default;

  virtual absl::Status Publish(const Event& event) = 0;
  virtual absl::Status Publish(const Heartbeat& heartbeat) = 0;
};

}  // namespace mortise::bus
