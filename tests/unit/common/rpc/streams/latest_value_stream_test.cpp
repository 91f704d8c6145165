// The frame of streams on which the latest value counts, without a wire.
#include "common/rpc/streams/latest_value_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"

namespace mortise::rpc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Message {
  std::string text;  // "begin …", "last …", or a value
  bool has_begin() const { return text.starts_with("begin"); }
};

// Says what it is told.
class Echo : public FollowedSubject<Message, std::string> {
 public:
  using Texts = absl::StatusOr<std::vector<std::string>>;

  Texts Begin(const Message& message) override {
    if (message.text == "begin with nothing") return absl::NotFoundError("there is nothing");
    return message.text == "begin" ? std::vector<std::string>() : std::vector{message.text};
  }
  absl::StatusOr<Kind> Take(const Message& message) override {
    if (message.text.empty()) return InvalidField("message", "is missing");
    return message.text.starts_with("last") ? Kind::kLast : Kind::kValue;
  }
  Texts Answer(const Message& message) override {
    if (message.text == "impossible") return absl::InternalError("it cannot be");
    if (message.text == "silent") return std::vector<std::string>();
    if (message.text == "long") return std::vector<std::string>{"long, begun", "long, done"};
    return std::vector{message.text};
  }
};

// Sends when it is told to.
class PulledWriter : public StreamWriter<std::string> {
 public:
  bool Write(std::string) override { return false; }
  bool WriteLatest(std::string) override { return false; }
  void Pull(std::function<absl::StatusOr<std::optional<std::string>>()> next) override {
    next_ = std::move(next);
  }
  void Wake() override { ++wakes; }
  void Finish(absl::Status status) override {
    if (!ended) ended = std::move(status);
  }
  bool cancelled() const override { return ended.has_value(); }
  void OnEnd(std::function<void()>) override {}

  // All that there is to send.
  std::vector<std::string> Sent() {
    std::vector<std::string> sent;
    while (next_ && !ended) {
      auto next = next_();
      if (!next.ok()) {
        ended = next.status();
        break;
      }
      if (!*next) break;
      sent.push_back(**std::move(next));
    }
    return sent;
  }

  int wakes = 0;
  std::optional<absl::Status> ended;

 private:
  std::function<absl::StatusOr<std::optional<std::string>>()> next_;
};

class LatestValueStreamTest : public ::testing::Test {
 protected:
  absl::Status Say(const std::string& text) { return reader_->OnMessage({text}); }

  const std::shared_ptr<PulledWriter> writer_ = std::make_shared<PulledWriter>();
  const std::unique_ptr<StreamReader<Message>> reader_ =
      FollowLatest<Message, std::string>(std::make_shared<Echo>(), writer_);
};

TEST_F(LatestValueStreamTest, OfValuesThatWaitTheLatestIsAnswered) {
  ASSERT_OK(Say("begin at 1"));
  ASSERT_OK(Say("2"));
  ASSERT_OK(Say("3"));
  EXPECT_THAT(writer_->Sent(), ElementsAre("begin at 1", "3"));
  ASSERT_OK(Say("4"));
  EXPECT_EQ(writer_->wakes, 3);
  EXPECT_THAT(writer_->Sent(), ElementsAre("4"));
  EXPECT_THAT(writer_->Sent(), IsEmpty());
  EXPECT_FALSE(writer_->ended);
}

TEST_F(LatestValueStreamTest, WhatWaitsIsAnsweredBeforeTheEnd) {
  ASSERT_OK(Say("begin"));
  ASSERT_OK(Say("long"));
  reader_->OnEnd();
  EXPECT_THAT(writer_->Sent(), ElementsAre("long, begun", "long, done"));
  EXPECT_EQ(writer_->ended, absl::OkStatus());
}

TEST_F(LatestValueStreamTest, AnAnswerMayBeNothing) {
  ASSERT_OK(Say("begin"));
  ASSERT_OK(Say("silent"));
  EXPECT_THAT(writer_->Sent(), IsEmpty());
  EXPECT_FALSE(writer_->ended);
  ASSERT_OK(Say("2"));
  EXPECT_THAT(writer_->Sent(), ElementsAre("2"));
}

TEST_F(LatestValueStreamTest, TheLastMessageEndsItInPlaceOfWhatWaits) {
  ASSERT_OK(Say("begin"));
  ASSERT_OK(Say("2"));
  ASSERT_OK(Say("last"));
  const absl::Status late = Say("3");
  EXPECT_EQ(DetailOf(late).field, "message");
  EXPECT_THAT(std::string(late.message()), HasSubstr("nothing comes after the last"));
  EXPECT_THAT(writer_->Sent(), ElementsAre("last"));
  EXPECT_EQ(writer_->ended, absl::OkStatus());
}

TEST_F(LatestValueStreamTest, ItBeginsOnceAndFirst) {
  EXPECT_THAT(std::string(Say("2").message()), HasSubstr("the first must be begin"));
  ASSERT_OK(Say("begin"));
  EXPECT_THAT(std::string(Say("begin").message()), HasSubstr("it has begun already"));
  EXPECT_THAT(std::string(Say("").message()), HasSubstr("is missing"));
}

TEST_F(LatestValueStreamTest, WithoutABeginItEndsWithAReason) {
  EXPECT_EQ(Say("begin with nothing").code(), absl::StatusCode::kNotFound);
  EXPECT_FALSE(writer_->ended);
  reader_->OnEnd();
  ASSERT_TRUE(writer_->ended);
  EXPECT_EQ(DetailOf(*writer_->ended).field, "message");
}

TEST_F(LatestValueStreamTest, AFailedAnswerEndsIt) {
  ASSERT_OK(Say("begin"));
  ASSERT_OK(Say("impossible"));
  EXPECT_THAT(writer_->Sent(), IsEmpty());
  ASSERT_TRUE(writer_->ended);
  EXPECT_EQ(writer_->ended->code(), absl::StatusCode::kInternal);
}

// Who keeps the writer alive does not depend on what it calls.
TEST(LatestValueStreamLifeTest, ItDoesNotKeepItsWriter) {
  auto writer = std::make_shared<PulledWriter>();
  auto reader = FollowLatest<Message, std::string>(std::make_shared<Echo>(), writer);
  ASSERT_OK(reader->OnMessage({"begin"}));
  reader.reset();
  const std::weak_ptr<PulledWriter> weak = writer;
  writer.reset();
  EXPECT_TRUE(weak.expired());
}

}  // namespace
}  // namespace mortise::rpc
