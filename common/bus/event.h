// What travels on the bus, and its encoding.
//
// A message is a ZeroMQ multipart of three frames: topic, header, payload. The topic of an event is
// "<stream>/<type>", so that a subscriber can ask for a prefix: "catalog/", "catalog/design.". A
// heartbeat has the topic "<stream>/~heartbeat" and an empty payload; it tells the number of the
// stream's last event, so that the loss even of that one is noticed.
//
// The header, all integers little-endian:
//   4 bytes "MTS1" · 1 byte kind (1 event, 2 heartbeat) · int64 epoch · int64 number
//   · int64 time (microseconds since 1970) · then stream, type, subject, trace id, each as
//   uint16 length and bytes (type, subject and trace id are empty in a heartbeat).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace mortise::bus {

// A fact that happened, at its place in its stream.
struct Event {
  std::string stream = {};   // the service that tells it: "catalog"
  int64_t epoch = 0;         // grows with every takeover of the stream's relay
  int64_t number = 0;        // 1, 2, 3 … without gaps within the stream, across epochs
  std::string type = {};     // "design.created"
  std::string subject = {};  // resource name
  std::string payload = {};  // opaque bytes
  std::string trace_id = {};
  absl::Time time = {};
};

// "The last event of `stream` is `number`."
struct Heartbeat {
  std::string stream = {};
  int64_t epoch = 0;
  int64_t number = 0;
  absl::Time time = {};
};

// One message as its three frames.
struct Frames {
  std::string topic = {};
  std::string header = {};
  std::string payload = {};
};

// A decoded message is one of the two.
struct Message {
  enum class Kind { kEvent, kHeartbeat };
  Kind kind = Kind::kEvent;
  Event event = {};          // of kEvent
  Heartbeat heartbeat = {};  // of kHeartbeat
};

// Strings past 65535 bytes are cut to that length (store::AppendEvent refuses them far earlier).
Frames Encode(const Event& event);
Frames Encode(const Heartbeat& heartbeat);

// Returns the message of three frames. INVALID_ARGUMENT naming the part that is malformed: a wrong
// magic, kind or length, a negative number, or a topic that does not agree with the header. Never
// trusts its input.
absl::StatusOr<Message> Decode(std::string_view topic, std::string_view header,
                               std::string_view payload);

}  // namespace mortise::bus
