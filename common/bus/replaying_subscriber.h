// The dependable subscriber: every event of its streams, in order, once for each number.
//
// Live messages come from the bus. Where a number is skipped, where the subscriber starts late, or
// where a heartbeat (or a silent bus) shows that the last event was lost, it asks the source for
// what it lacks. The handler stores the cursor (the last number it handled) together with the
// effect of the events, in one transaction; after a restart that cursor is given back as
// Options::cursors, and no event is missed or applied twice.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/bus/event.h"
#include "common/bus/subscriber.h"

namespace mortise::bus {

// Asks the source of `stream` for events after `after_number`, at most `limit`, in order: an
// EventService call in production, Store::ReadEvents in the same process.
using FetchEvents = std::function<absl::StatusOr<std::vector<Event>>(
    const std::string& stream, int64_t after_number, int limit)>;

// Takes consecutive events of one stream. After OK the last number is the new cursor; otherwise
// the same events come again after `retry` (possibly with more behind them).
using HandleEvents = std::function<absl::Status(std::span<const Event> events)>;

struct ReplayOptions {
  std::string endpoint = {};  // the broker's subscriber endpoint
  ClientSecurity security = {};
  std::map<std::string, int64_t> cursors =
      {};  // streams to follow, each with the last number handled
  FetchEvents fetch = {};
  HandleEvents handle = {};
  int fetch_limit = 1000;                          // events asked for in one fetch
  int batch = 1000;                                // events given to the handler at once, at most
  absl::Duration retry = absl::Milliseconds(200);  // after a failed fetch or handler
  absl::Duration silence = absl::Seconds(5);       // ask the source when the bus is silent so long
};

// Runs `fetch` and `handle` on one thread of its own, first for what was missed, then live.
class ReplayingSubscriber {
 public:
  // INVALID_ARGUMENT if a callback is missing or the endpoint is bad.
  static absl::StatusOr<std::unique_ptr<ReplayingSubscriber>> Start(ReplayOptions options);

  // Stops after the batch in hand.
  virtual ~ReplayingSubscriber() = default;

  // Returns the last number handled of `stream`.
  virtual int64_t cursor(const std::string& stream) const = 0;

  // Returns how many events came through fetches rather than live.
  virtual int64_t fetched() const = 0;

  // Waits until the cursor of `stream` has reached `number`; false if that took longer.
  virtual bool WaitFor(const std::string& stream, int64_t number, absl::Duration timeout) = 0;
};

}  // namespace mortise::bus
