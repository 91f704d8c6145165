#include "common/bus/event.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::bus {
namespace {

constexpr std::string_view kMagic = "MTS1";
constexpr char kEventKind = 1;
constexpr char kHeartbeatKind = 2;
constexpr std::string_view kHeartbeatType = "~heartbeat";

void AppendInteger(int64_t value, int bytes, std::string* out) {
  const auto bits = static_cast<uint64_t>(value);
  for (int i = 0; i < bytes; ++i) out->push_back(static_cast<char>(bits >> (8 * i)));
}

void AppendText(std::string_view text, std::string* out) {
  text = text.substr(0, std::numeric_limits<uint16_t>::max());
  AppendInteger(static_cast<int64_t>(text.size()), 2, out);
  out->append(text);
}

std::string TopicOf(std::string_view stream, std::string_view type) {
  std::string topic;
  topic.reserve(stream.size() + 1 + type.size());
  topic.append(stream).append("/").append(type);
  return topic;
}

std::string StartHeader(char kind, int64_t epoch, int64_t number, absl::Time time) {
  std::string header(kMagic);
  header.reserve(160);
  header.push_back(kind);
  AppendInteger(epoch, 8, &header);
  AppendInteger(number, 8, &header);
  AppendInteger(absl::ToUnixMicros(time), 8, &header);
  return header;
}

// Takes values off the front of a header. After a value that is not there, everything reads as
// nothing and ok() is false.
class HeaderReader {
 public:
  explicit HeaderReader(std::string_view bytes) : rest_(bytes) {}

  bool ok() const { return ok_; }
  bool at_end() const { return rest_.empty(); }

  std::string_view Bytes(std::size_t count) {
    if (!ok_ || rest_.size() < count) {
      ok_ = false;
      return {};
    }
    const std::string_view bytes = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return bytes;
  }

  int64_t Integer(std::size_t count) {
    uint64_t bits = 0;
    const std::string_view bytes = Bytes(count);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      bits |= uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
    }
    return static_cast<int64_t>(bits);
  }

  std::string Text() { return std::string(Bytes(static_cast<std::size_t>(Integer(2)))); }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

absl::Status CheckEvent(const Event& event, std::string_view topic) {
  if (event.stream.empty()) return InvalidField("header.stream", "must not be empty");
  if (event.epoch < 0) return InvalidField("header.epoch", "must not be negative");
  if (event.number < 1) return InvalidField("header.number", "must be positive");
  if (topic != TopicOf(event.stream, event.type)) {
    return InvalidField("topic", "does not agree with the header");
  }
  return absl::OkStatus();
}

absl::Status CheckHeartbeat(const Event& read, std::string_view topic, std::string_view payload) {
  if (read.stream.empty()) return InvalidField("header.stream", "must not be empty");
  if (read.epoch < 0) return InvalidField("header.epoch", "must not be negative");
  if (read.number < 0) return InvalidField("header.number", "must not be negative");
  if (!read.type.empty() || !read.subject.empty() || !read.trace_id.empty() || !payload.empty()) {
    return InvalidField("header", "a heartbeat has no type, subject, trace id or payload");
  }
  if (topic != TopicOf(read.stream, kHeartbeatType)) {
    return InvalidField("topic", "does not agree with the header");
  }
  return absl::OkStatus();
}

}  // namespace

Frames Encode(const Event& event) {
  Frames frames{.topic = TopicOf(event.stream, event.type),
                .header = StartHeader(kEventKind, event.epoch, event.number, event.time),
                .payload = event.payload};
  for (const std::string* text : {&event.stream, &event.type, &event.subject, &event.trace_id}) {
    AppendText(*text, &frames.header);
  }
  return frames;
}

Frames Encode(const Heartbeat& heartbeat) {
  Frames frames{
      .topic = TopicOf(heartbeat.stream, kHeartbeatType),
      .header = StartHeader(kHeartbeatKind, heartbeat.epoch, heartbeat.number, heartbeat.time)};
  for (const std::string_view text : {std::string_view(heartbeat.stream), std::string_view(),
                                      std::string_view(), std::string_view()}) {
    AppendText(text, &frames.header);
  }
  return frames;
}

absl::StatusOr<Message> Decode(std::string_view topic, std::string_view header,
                               std::string_view payload) {
  HeaderReader reader(header);
  if (reader.Bytes(kMagic.size()) != kMagic) return InvalidField("header.magic", "is not MTS1");
  const auto kind = static_cast<char>(reader.Integer(1));
  Event event;
  event.epoch = reader.Integer(8);
  event.number = reader.Integer(8);
  event.time = absl::FromUnixMicros(reader.Integer(8));
  event.stream = reader.Text();
  event.type = reader.Text();
  event.subject = reader.Text();
  event.trace_id = reader.Text();
  if (!reader.ok()) return InvalidField("header", "is too short");
  if (!reader.at_end()) return InvalidField("header", "is too long");

  Message message;
  if (kind == kEventKind) {
    MORTISE_RETURN_IF_ERROR(CheckEvent(event, topic));
    event.payload = payload;
    message.event = std::move(event);
    return message;
  }
  if (kind == kHeartbeatKind) {
    MORTISE_RETURN_IF_ERROR(CheckHeartbeat(event, topic, payload));
    message.kind = Message::Kind::kHeartbeat;
    message.heartbeat = {.stream = std::move(event.stream),
                         .epoch = event.epoch,
                         .number = event.number,
                         .time = event.time};
    return message;
  }
  return InvalidField("header.kind", "is neither event nor heartbeat");
}

}  // namespace mortise::bus
