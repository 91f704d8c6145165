// The sending side of a stream, as its handler sees it: push when something happens, or be asked
// when there is room. An idle stream holds no thread.
#pragma once

#include <functional>
#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::rpc {

struct StreamOptions {
  int capacity = 256;  // messages that wait for a slow reader before Write gives up
  // Whether the stream has no end of its own: it is then ended (UNAVAILABLE, SHUTTING_DOWN) as soon
  // as the server drains, and the client follows on elsewhere.
  bool endless = false;
};

// Thread safe; usable from any thread, and harmlessly after the stream has ended. Messages are sent
// in the order of the calls.
template <class Response>
class StreamWriter {
 public:
  virtual ~StreamWriter() = default;

  // Queues a message; never blocks. False if the stream has ended. A reader so slow that `capacity`
  // messages wait is cut off with RESOURCE_EXHAUSTED, SLOW_READER.
  virtual bool Write(Response message) = 0;

  // The same, but replaces the last message if that has not been sent yet: for states of which only
  // the latest matters. Never cuts off.
  virtual bool WriteLatest(Response message) = 0;

  // From now on `next` is called, on the handlers' threads, one call at a time, whenever there is
  // room: a message, or nothing if there is none yet (Wake tells when there is), or an error that
  // ends the stream. To end it well, `next` calls Finish(absl::OkStatus()) and returns nothing.
  virtual void Pull(std::function<absl::StatusOr<std::optional<Response>>()> next) = 0;

  // Says that `next` has something again.
  virtual void Wake() = 0;

  // Ends the stream after what is queued. Only the first call counts.
  virtual void Finish(absl::Status status) = 0;

  // Whether nobody reads any more.
  virtual bool cancelled() const = 0;

  // Runs `callback` on the handlers' threads, once, when the stream ends for whatever reason; at
  // once if it has. Use it to let go of what feeds the stream.
  virtual void OnEnd(std::function<void()> callback) = 0;
};

}  // namespace mortise::rpc
