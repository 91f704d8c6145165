// A broker, a publisher and a store with its relay, wired as in a service: for tests of events.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/broker.h"
#include "common/bus/outbox_relay.h"
#include "common/bus/publisher.h"
#include "common/bus/replaying_subscriber.h"
#include "common/store/store.h"

namespace mortise::testing {

// A plain broker on free loopback ports.
inline std::unique_ptr<bus::Broker> StartBroker() { return bus::Broker::Start({}).value(); }

// Writes `count` events in one transaction, with payloads first, first + 1 …
inline absl::Status AppendEvents(store::Store* store, int64_t first, int64_t count) {
  return store->Transact([&](store::Transaction& transaction) -> absl::Status {
    for (int64_t i = 0; i < count; ++i) {
      absl::Status status = transaction.AppendEvent(
          {.type = "thing.done", .subject = "things/x", .payload = std::to_string(first + i)});
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  });
}

// What an EventService would answer.
inline bus::FetchEvents FetchFrom(store::Store* store) {
  return [store](const std::string& stream, int64_t after,
                 int limit) -> absl::StatusOr<std::vector<bus::Event>> {
    std::vector<bus::Event> events;
    absl::Status status = store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      absl::StatusOr<std::vector<store::NumberedEvent>> stored =
          transaction.ReadEvents(after, limit);
      if (!stored.ok()) return stored.status();
      for (store::NumberedEvent& event : *stored) {
        events.push_back({.stream = stream,
                          .epoch = event.epoch,
                          .number = event.number,
                          .type = std::move(event.type),
                          .subject = std::move(event.subject),
                          .payload = std::move(event.payload),
                          .trace_id = std::move(event.trace_id),
                          .time = event.time});
      }
      return absl::OkStatus();
    });
    if (!status.ok()) return status;
    return events;
  };
}

}  // namespace mortise::testing
