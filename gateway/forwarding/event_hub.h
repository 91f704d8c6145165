// The events of all services in one place: what is new comes over the bus, what was missed is asked
// from the service it happened in. The gateway's followers, event streams and webhooks read here.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/bus/event.h"
#include "common/bus/replaying_subscriber.h"
#include "common/bus/security.h"

namespace mortise::gateway {

struct EventHubOptions {
  std::string endpoint;  // the broker's subscriber endpoint
  bus::ClientSecurity security;
  std::vector<std::string> streams;  // the services
  bus::FetchEvents fetch;            // from the service; may block for as long as a call
  // The number of a stream's latest event, from the service.
  std::function<absl::StatusOr<int64_t>(const std::string& stream)> latest;
  std::size_t kept = 4096;                         // recent events kept of each stream
  absl::Duration retry = absl::Milliseconds(250);  // while a service cannot be reached
};

// Returns NOT_FOUND for a stream that there is not.
absl::Status NoSuchStream(std::string_view stream);

class EventHub {
 public:
  // Starts a thread for each stream, which waits for its service and then listens.
  static std::unique_ptr<EventHub> Start(EventHubOptions options);
  virtual ~EventHub() = default;

  virtual const std::vector<std::string>& streams() const = 0;

  // Events of a stream after `after`, at most `limit`, in order, none missing; empty if there are
  // none yet. Asks the service for what is no longer kept, and then blocks. NOT_FOUND for a stream
  // that there is not; UNAVAILABLE if the service is needed and cannot be reached.
  virtual absl::StatusOr<std::vector<bus::Event>> Read(const std::string& stream, int64_t after,
                                                       int limit) = 0;

  // Returns the number of the latest event known; nothing while the service was never reached.
  virtual std::optional<int64_t> Latest(const std::string& stream) const = 0;

  // Runs `callback`, which must be quick, whenever a stream has new events, until the token goes.
  virtual std::shared_ptr<void> OnEvents(
      std::function<void(const std::string& stream)> callback) = 0;
};

}  // namespace mortise::gateway
