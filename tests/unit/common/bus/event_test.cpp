// The wire format: what is encoded is decoded, and nothing else is.
#include "common/bus/event.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"

namespace mortise::bus {
namespace {

Event SomeEvent() {
  return {.stream = "catalog",
          .epoch = 1'700'000'000'000,
          .number = 42,
          .type = "design.created",
          .subject = "designs/tische-ä",
          .payload = std::string("\0\x01\xFF", 3),
          .trace_id = "r1",
          .time = absl::FromUnixMicros(1'700'000'000'123'456)};
}

absl::StatusOr<Message> DecodeFrames(const Frames& frames) {
  return Decode(frames.topic, frames.header, frames.payload);
}

std::string FieldOf(const absl::StatusOr<Message>& message) {
  EXPECT_EQ(message.status().code(), absl::StatusCode::kInvalidArgument);
  return DetailOf(message.status()).field;
}

TEST(EventEncoding, AnEventComesBack) {
  const Event event = SomeEvent();
  const Frames frames = Encode(event);
  EXPECT_EQ(frames.topic, "catalog/design.created");
  const absl::StatusOr<Message> message = DecodeFrames(frames);
  ASSERT_OK(message);
  EXPECT_EQ(message->kind, Message::Kind::kEvent);
  EXPECT_EQ(message->event.stream, event.stream);
  EXPECT_EQ(message->event.epoch, event.epoch);
  EXPECT_EQ(message->event.number, event.number);
  EXPECT_EQ(message->event.type, event.type);
  EXPECT_EQ(message->event.subject, event.subject);
  EXPECT_EQ(message->event.payload, event.payload);
  EXPECT_EQ(message->event.trace_id, event.trace_id);
  EXPECT_EQ(message->event.time, event.time);
}

TEST(EventEncoding, AHeartbeatComesBack) {
  const Heartbeat heartbeat{
      .stream = "catalog", .epoch = 3, .number = 0, .time = absl::FromUnixMicros(-5)};
  const Frames frames = Encode(heartbeat);
  EXPECT_EQ(frames.topic, "catalog/~heartbeat");
  const absl::StatusOr<Message> message = DecodeFrames(frames);
  ASSERT_OK(message);
  EXPECT_EQ(message->kind, Message::Kind::kHeartbeat);
  EXPECT_EQ(message->heartbeat.stream, "catalog");
  EXPECT_EQ(message->heartbeat.epoch, 3);
  EXPECT_EQ(message->heartbeat.number, 0);
  EXPECT_EQ(message->heartbeat.time, absl::FromUnixMicros(-5));
}

TEST(EventEncoding, TheHeaderIsAsDocumented) {
  const Frames frames = Encode(
      Heartbeat{.stream = "ab", .epoch = 1, .number = 0x0203, .time = absl::FromUnixMicros(4)});
  EXPECT_EQ(frames.header, std::string("MTS1\x02"
                                       "\1\0\0\0\0\0\0\0"
                                       "\3\2\0\0\0\0\0\0"
                                       "\4\0\0\0\0\0\0\0"
                                       "\2\0ab\0\0\0\0\0\0",
                                       5 + 24 + 10));
}

TEST(EventEncoding, EveryTruncationIsRefused) {
  Frames frames = Encode(SomeEvent());
  const std::string whole = frames.header;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    frames.header = whole.substr(0, length);
    EXPECT_FALSE(DecodeFrames(frames).ok()) << length;
  }
  frames.header = whole + "x";
  EXPECT_EQ(FieldOf(DecodeFrames(frames)), "header");
}

TEST(EventEncoding, WhatDoesNotAgreeIsRefused) {
  const Frames good = Encode(SomeEvent());
  Frames bad = good;
  bad.topic = "catalog/design.updated";
  EXPECT_EQ(FieldOf(DecodeFrames(bad)), "topic");
  bad = good;
  bad.header[0] = 'X';
  EXPECT_EQ(FieldOf(DecodeFrames(bad)), "header.magic");
  bad = good;
  bad.header[4] = 7;
  EXPECT_EQ(FieldOf(DecodeFrames(bad)), "header.kind");
  Event event = SomeEvent();
  event.number = 0;
  EXPECT_EQ(FieldOf(DecodeFrames(Encode(event))), "header.number");
  event = SomeEvent();
  event.epoch = -1;
  EXPECT_EQ(FieldOf(DecodeFrames(Encode(event))), "header.epoch");
  event = SomeEvent();
  event.stream = "";
  EXPECT_EQ(FieldOf(DecodeFrames(Encode(event))), "header.stream");
  Frames heartbeat = Encode(Heartbeat{.stream = "catalog", .number = 1});
  heartbeat.payload = "x";
  EXPECT_EQ(FieldOf(DecodeFrames(heartbeat)), "header");
}

// Flipping bytes at random never crashes, and what is still accepted encodes to the same bytes.
TEST(EventEncoding, AcceptedMessagesEncodeToThemselves) {
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    Frames frames = Encode(SomeEvent());
    std::string* frame = i % 2 == 0 ? &frames.header : &frames.topic;
    for (int k = 0; k < 1 + i % 3; ++k) {
      (*frame)[random() % frame->size()] = static_cast<char>(random());
    }
    const absl::StatusOr<Message> message = DecodeFrames(frames);
    if (!message.ok()) continue;
    ASSERT_EQ(message->kind, Message::Kind::kEvent);
    const Frames again = Encode(message->event);
    EXPECT_EQ(again.topic, frames.topic);
    EXPECT_EQ(again.header, frames.header);
  }
}

}  // namespace
}  // namespace mortise::bus
