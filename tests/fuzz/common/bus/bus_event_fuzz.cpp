// Feeds bytes to the bus's decoder: the first two say how long topic and header are.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/bus/event.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  std::string_view rest(reinterpret_cast<const char*>(data) + 2, size - 2);
  const std::string_view topic = rest.substr(0, data[0]);
  rest.remove_prefix(topic.size());
  const std::string_view header = rest.substr(0, data[1]);
  rest.remove_prefix(header.size());
  const auto message = mortise::bus::Decode(topic, header, rest);
  if (!message.ok()) return 0;
  // What is accepted encodes to the same bytes.
  const bool is_event = message->kind == mortise::bus::Message::Kind::kEvent;
  const mortise::bus::Frames again =
      is_event ? mortise::bus::Encode(message->event) : mortise::bus::Encode(message->heartbeat);
  if (again.topic != topic || again.header != header || again.payload != rest) std::abort();
  return 0;
}
