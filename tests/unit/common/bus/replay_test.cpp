// From outbox to subscriber: in order, once for each number, whatever gets lost on the way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/bus/subscriber.h"
#include "tests/support/house_bus.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::bus {
namespace {

using testing::AppendEvents;

// Lets through what `passes` says, and all heartbeats if `heartbeats`.
class LossyPublisher final : public Publisher {
 public:
  LossyPublisher(Publisher* publisher, std::function<bool(int64_t)> passes, bool heartbeats)
      : publisher_(publisher), passes_(std::move(passes)), heartbeats_(heartbeats) {}
  absl::Status Publish(const Event& event) override {
    return passes_(event.number) ? publisher_->Publish(event) : absl::OkStatus();
  }
  absl::Status Publish(const Heartbeat& heartbeat) override {
    return heartbeats_ ? publisher_->Publish(heartbeat) : absl::OkStatus();
  }

 private:
  Publisher* publisher_;
  std::function<bool(int64_t)> passes_;
  bool heartbeats_;
};

class ReplayTest : public ::testing::Test {
 protected:
  void SetUp() override {
    store_ = store::OpenStore({.url = "sqlite:" + (folder_.path() / "s.db").string()}).value();
    broker_ = testing::StartBroker();
    publisher_ = Publisher::Connect({.endpoint = broker_->publisher_endpoint()}).value();
  }

  std::unique_ptr<OutboxRelay> StartRelay(Publisher* publisher) {
    return OutboxRelay::Start({.stream = "s",
                               .heartbeat = absl::Milliseconds(20),
                               .poll = absl::Milliseconds(20),
                               .batch = 100},
                              store_.get(), publisher);
  }

  ReplayOptions Options(int64_t cursor = 0) {
    ReplayOptions options;
    options.endpoint = broker_->subscriber_endpoint();
    options.cursors = {{"s", cursor}};
    options.fetch = testing::FetchFrom(store_.get());
    options.handle = [this](std::span<const Event> events) {
      std::lock_guard lock(mutex_);
      for (const Event& event : events) {
        numbers_.push_back(event.number);
        payloads_.insert(event.payload);
      }
      return absl::OkStatus();
    };
    options.retry = absl::Milliseconds(5);
    return options;
  }

  // All of first … last came, in order, each once.
  void ExpectNumbers(int64_t first, int64_t last) {
    std::lock_guard lock(mutex_);
    ASSERT_EQ(numbers_.size(), static_cast<std::size_t>(last - first + 1));
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      ASSERT_EQ(numbers_[i], first + static_cast<int64_t>(i));
    }
    EXPECT_EQ(payloads_.size(), numbers_.size());
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_;
  std::unique_ptr<Broker> broker_;
  std::unique_ptr<Publisher> publisher_;
  std::mutex mutex_;
  std::vector<int64_t> numbers_;    // guarded by mutex_
  std::set<std::string> payloads_;  // guarded by mutex_
};

constexpr absl::Duration kPatience = absl::Seconds(60);

TEST_F(ReplayTest, EventsArriveInOrder) {
  auto subscriber = ReplayingSubscriber::Start(Options()).value();
  auto relay = StartRelay(publisher_.get());
  for (int i = 0; i < 100; ++i) ASSERT_OK(AppendEvents(store_.get(), i * 10, 10));
  EXPECT_TRUE(relay->WaitForPublished(1000, kPatience));
  ASSERT_TRUE(subscriber->WaitFor("s", 1000, kPatience));
  EXPECT_EQ(subscriber->cursor("s"), 1000);
  ExpectNumbers(1, 1000);
}

TEST_F(ReplayTest, OnceConnectedEventsComeLive) {
  auto subscriber = ReplayingSubscriber::Start(Options()).value();
  auto relay = StartRelay(publisher_.get());
  int64_t written = 0;
  // The first ones may need fetching, until the connections are up.
  const absl::Time deadline = absl::Now() + kPatience;
  int64_t fetched = -1;
  while (subscriber->fetched() != fetched && absl::Now() < deadline) {
    fetched = subscriber->fetched();
    ASSERT_OK(AppendEvents(store_.get(), written, 50));
    written += 50;
    ASSERT_TRUE(subscriber->WaitFor("s", written, kPatience));
  }
  EXPECT_EQ(subscriber->fetched(), fetched) << "a whole round came live";
  ExpectNumbers(1, written);
}

TEST_F(ReplayTest, ALateSubscriberGetsEverything) {
  auto relay = StartRelay(publisher_.get());
  ASSERT_OK(AppendEvents(store_.get(), 0, 5000));
  ASSERT_TRUE(relay->WaitForPublished(5000, kPatience));
  auto subscriber = ReplayingSubscriber::Start(Options()).value();
  ASSERT_TRUE(subscriber->WaitFor("s", 5000, kPatience));
  ExpectNumbers(1, 5000);
}

TEST_F(ReplayTest, AStoppedSubscriberCatchesUpFrom100000EventsBehind) {
  auto relay = StartRelay(publisher_.get());
  ASSERT_OK(AppendEvents(store_.get(), 0, 10));
  int64_t cursor = 0;
  {
    auto subscriber = ReplayingSubscriber::Start(Options()).value();
    ASSERT_TRUE(subscriber->WaitFor("s", 10, kPatience));
    cursor = subscriber->cursor("s");
  }
  for (int i = 0; i < 200; ++i) ASSERT_OK(AppendEvents(store_.get(), 10 + i * 500, 500));
  auto subscriber = ReplayingSubscriber::Start(Options(cursor)).value();
  ASSERT_TRUE(subscriber->WaitFor("s", 100010, kPatience));
  ExpectNumbers(1, 100010);
}

TEST_F(ReplayTest, AHeartbeatTellsOfTheLostLastEvent) {
  LossyPublisher lossy(
      publisher_.get(), [](int64_t) { return false; }, true);
  auto subscriber = ReplayingSubscriber::Start(Options()).value();
  auto relay = StartRelay(&lossy);
  for (int64_t i = 0; i < 5; ++i) {
    ASSERT_OK(AppendEvents(store_.get(), i, 1));
    ASSERT_TRUE(subscriber->WaitFor("s", i + 1, kPatience));
  }
  ExpectNumbers(1, 5);
  EXPECT_EQ(subscriber->fetched(), 5);
}

TEST_F(ReplayTest, GapsAreFilled) {
  LossyPublisher lossy(
      publisher_.get(), [](int64_t number) { return number % 7 < 4; }, true);
  auto subscriber = ReplayingSubscriber::Start(Options()).value();
  auto relay = StartRelay(&lossy);
  for (int i = 0; i < 50; ++i) ASSERT_OK(AppendEvents(store_.get(), i * 20, 20));
  ASSERT_TRUE(subscriber->WaitFor("s", 1000, kPatience));
  ExpectNumbers(1, 1000);
}

TEST_F(ReplayTest, ASilentBusIsNoticed) {
  LossyPublisher dead(
      publisher_.get(), [](int64_t) { return false; }, false);
  ReplayOptions options = Options();
  options.silence = absl::Milliseconds(20);
  auto subscriber = ReplayingSubscriber::Start(options).value();
  auto relay = StartRelay(&dead);
  ASSERT_OK(AppendEvents(store_.get(), 0, 30));
  ASSERT_TRUE(subscriber->WaitFor("s", 30, kPatience));
  ExpectNumbers(1, 30);
}

TEST_F(ReplayTest, FailuresOfHandlerAndSourceAreRetried) {
  std::atomic<int> calls = 0;
  ReplayOptions options = Options();
  options.batch = 7;
  options.fetch_limit = 10;
  options.retry = absl::Milliseconds(1);
  options.handle = [&, inner = options.handle](std::span<const Event> events) {
    if (++calls % 3 == 1) return absl::UnavailableError("not now");
    return inner(events);
  };
  options.fetch = [&, inner = options.fetch](const std::string& stream, int64_t after,
                                             int limit) -> absl::StatusOr<std::vector<Event>> {
    if (++calls % 3 == 1) return absl::UnavailableError("not now");
    return inner(stream, after, limit);
  };
  auto subscriber = ReplayingSubscriber::Start(options).value();
  auto relay = StartRelay(publisher_.get());
  for (int i = 0; i < 20; ++i) ASSERT_OK(AppendEvents(store_.get(), i * 20, 20));
  ASSERT_TRUE(subscriber->WaitFor("s", 400, kPatience));
  ExpectNumbers(1, 400);
}

TEST_F(ReplayTest, ASourceThatSkipsIsNotBelieved) {
  std::atomic<int> lies = 3;
  ReplayOptions options = Options();
  options.fetch = [&, inner = options.fetch](const std::string& stream, int64_t after,
                                             int limit) -> absl::StatusOr<std::vector<Event>> {
    auto events = inner(stream, after, limit);
    if (events.ok() && events->size() > 1 && lies-- > 0) events->erase(events->begin());
    return events;
  };
  auto relay = StartRelay(publisher_.get());
  ASSERT_OK(AppendEvents(store_.get(), 0, 100));
  ASSERT_TRUE(relay->WaitForPublished(100, kPatience));
  auto subscriber = ReplayingSubscriber::Start(options).value();
  ASSERT_TRUE(subscriber->WaitFor("s", 100, kPatience));
  ExpectNumbers(1, 100);
}

TEST_F(ReplayTest, ASubscriberHearsOnlyItsTopics) {
  auto subscriber =
      Subscriber::Connect({.endpoint = broker_->subscriber_endpoint(), .topics = {"s/design."}})
          .value();
  const absl::Time deadline = absl::Now() + kPatience;
  for (int64_t number = 1; absl::Now() < deadline; ++number) {
    ASSERT_OK(publisher_->Publish(Event{.stream = "s", .number = number, .type = "item.created"}));
    ASSERT_OK(
        publisher_->Publish(Event{.stream = "s", .number = number, .type = "design.created"}));
    const auto message = subscriber->Receive(absl::Milliseconds(20));
    ASSERT_OK(message);
    if (!message->has_value()) continue;
    EXPECT_EQ((*message)->event.type, "design.created");
    return;
  }
  ADD_FAILURE() << "nothing came";
}

TEST_F(ReplayTest, AnInterruptEndsTheWait) {
  auto subscriber =
      Subscriber::Connect({.endpoint = broker_->subscriber_endpoint(), .topics = {""}}).value();
  subscriber->Interrupt();
  const auto message = subscriber->Receive(absl::InfiniteDuration());
  ASSERT_OK(message);
  EXPECT_FALSE(message->has_value());
}

TEST_F(ReplayTest, BadOptionsAreNamed) {
  ReplayOptions options = Options();
  options.fetch = nullptr;
  EXPECT_EQ(DetailOf(ReplayingSubscriber::Start(options).status()).field, "fetch");
  options = Options();
  options.cursors["s"] = -1;
  EXPECT_EQ(DetailOf(ReplayingSubscriber::Start(options).status()).field, "cursors");
  options = Options();
  options.endpoint = "tcp://nowhere";
  EXPECT_FALSE(ReplayingSubscriber::Start(options).ok());
}

}  // namespace
}  // namespace mortise::bus
