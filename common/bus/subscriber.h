// Receives what is published while it listens: fast, but lossy. For telemetry, and as the ear of a
// ReplayingSubscriber.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/bus/event.h"
#include "common/bus/security.h"

namespace mortise::bus {

struct SubscriberOptions {
  std::string endpoint = {};  // the broker's subscriber endpoint
  ClientSecurity security = {};
  std::vector<std::string> topics = {};  // prefixes: "catalog/" or "" for everything
  int queue_length = 100000;             // messages held while the reader is slow; more are dropped
};

// Used by one thread at a time, apart from Interrupt. Connects and reconnects by itself.
class Subscriber {
 public:
  static absl::StatusOr<std::unique_ptr<Subscriber>> Connect(const SubscriberOptions& options);
  virtual ~Subscriber() = default;

  // Returns the next message, or nothing if none comes within `timeout` or Interrupt was called.
  // Malformed messages are logged and skipped.
  virtual absl::StatusOr<std::optional<Message>> Receive(absl::Duration timeout) = 0;

  // Makes the present or next Receive return at once. From any thread.
  virtual void Interrupt() = 0;
};

}  // namespace mortise::bus
