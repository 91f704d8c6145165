// EventService of one service process: its own event stream, over the store's numbered events.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace grpc {
class Service;
}
namespace mortise::store {
class Store;
}
namespace mortise::v1 {
class FollowEventsRequest;
}

namespace mortise::rpc {

class Dispatcher;

// Returns where a follower begins in the streams that it names a position of; `after_number` holds
// for the others. INVALID_ARGUMENT naming the field: numbers below -1, more than 64 positions, a
// stream that is named twice or not followed.
absl::StatusOr<std::map<std::string, int64_t>> FollowPositions(
    const v1::FollowEventsRequest& asked);

// Fails with INVALID_ARGUMENT naming `type_prefixes`: more than 100, or one of more than 256 bytes.
// Each is compared with every event, and kept for as long as somebody follows.
absl::Status CheckTypePrefixes(const google::protobuf::RepeatedPtrField<std::string>& prefixes);

// Tells followers that there are new numbered events. Thread safe.
class EventSignal {
 public:
  static std::shared_ptr<EventSignal> Create();
  virtual ~EventSignal() = default;

  // Runs all callbacks.
  virtual void Notify() = 0;

  // Runs `callback` at each Notify until the returned token goes away. The callback must be quick.
  virtual std::shared_ptr<void> Subscribe(std::function<void()> callback) = 0;
};

// `stream` is the service's name. Without a signal (a replica that does not relay) followers look
// once a second. `dispatcher` and `store` must outlive it.
std::shared_ptr<grpc::Service> MakeEventService(Dispatcher* dispatcher, store::Store* store,
                                                const std::string& stream,
                                                std::shared_ptr<EventSignal> signal);

}  // namespace mortise::rpc
