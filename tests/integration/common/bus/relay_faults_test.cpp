// The relay dies, or there are two: nothing is lost, and numbers have no gaps.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/time/time.h"
#include "tests/support/house_bus.h"
#include "tests/support/private_postgresql.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::bus {
namespace {

constexpr absl::Duration kPatience = absl::Seconds(60);

OutboxRelayOptions RelayOptions() {
  return {.stream = "s", .heartbeat = absl::Milliseconds(20), .poll = absl::Milliseconds(20)};
}

// Kills its process at the first event: numbered and committed, never published.
class DeadlyPublisher final : public Publisher {
 public:
  absl::Status Publish(const Event&) override {
    ::kill(::getpid(), SIGKILL);
    return absl::OkStatus();
  }
  absl::Status Publish(const Heartbeat&) override { return absl::OkStatus(); }
};

// Remembers what was published.
class RecordingPublisher final : public Publisher {
 public:
  absl::Status Publish(const Event& event) override {
    std::lock_guard lock(mutex_);
    events_.push_back(event);
    return absl::OkStatus();
  }
  absl::Status Publish(const Heartbeat&) override { return absl::OkStatus(); }
  std::vector<Event> events() {
    std::lock_guard lock(mutex_);
    return events_;
  }

 private:
  std::mutex mutex_;
  std::vector<Event> events_;  // guarded by mutex_
};

class KilledRelay : public ::testing::TestWithParam<bool> {};

// The child commits ten events and dies by SIGKILL: before its relay numbers them (false) or
// between numbering and publishing them (true). After the restart a subscriber gets all ten.
TEST_P(KilledRelay, EventsArriveAfterTheRestart) {
  testing::TemporaryFolder folder;
  const store::StoreOptions options{.url = "sqlite:" + (folder.path() / "s.db").string()};
  const pid_t child = ::fork();
  if (child == 0) {
    auto store = store::OpenStore(options).value();
    if (!testing::AppendEvents(store.get(), 0, 10).ok()) ::_exit(1);
    if (!GetParam()) ::kill(::getpid(), SIGKILL);
    DeadlyPublisher publisher;
    auto relay = OutboxRelay::Start(RelayOptions(), store.get(), &publisher);
    ::alarm(60);  // should the relay publish nothing
    ::pause();
    ::_exit(1);
  }
  int result = 0;
  ASSERT_EQ(::waitpid(child, &result, 0), child);
  ASSERT_TRUE(WIFSIGNALED(result) && WTERMSIG(result) == SIGKILL);

  auto store = store::OpenStore(options).value();
  auto broker = testing::StartBroker();
  auto publisher = Publisher::Connect({.endpoint = broker->publisher_endpoint()}).value();
  std::vector<std::string> payloads;
  ReplayOptions replay;
  replay.endpoint = broker->subscriber_endpoint();
  replay.cursors = {{"s", 0}};
  replay.fetch = testing::FetchFrom(store.get());
  replay.handle = [&](std::span<const Event> events) {
    for (const Event& event : events) payloads.push_back(event.payload);
    return absl::OkStatus();
  };
  auto subscriber = ReplayingSubscriber::Start(replay).value();
  auto relay = OutboxRelay::Start(RelayOptions(), store.get(), publisher.get());
  ASSERT_TRUE(subscriber->WaitFor("s", 10, kPatience));
  subscriber.reset();
  ASSERT_EQ(payloads.size(), 10u);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(payloads[static_cast<std::size_t>(i)], std::to_string(i));
}
INSTANTIATE_TEST_SUITE_P(Moments, KilledRelay, ::testing::Values(false, true));

// Two replicas on one PostgreSQL store, both writing: one relays; when it goes the other takes over
// in a new epoch; every event is published, and numbers are 1 … n without gaps.
TEST(TwoRelays, OneWorksAndTheOtherTakesOver) {
  auto cluster = testing::PrivatePostgresql::Start();
  ASSERT_OK(cluster);
  const store::StoreOptions options{.url = (*cluster)->url(), .service = "replicated"};
  auto store_a = store::OpenStore(options).value();
  auto store_b = store::OpenStore(options).value();
  RecordingPublisher publisher_a;
  RecordingPublisher publisher_b;
  auto relay_a = OutboxRelay::Start(RelayOptions(), store_a.get(), &publisher_a);
  EXPECT_OK(testing::AppendEvents(store_a.get(), 0, 1));
  ASSERT_TRUE(relay_a->WaitForPublished(1, kPatience)) << "it has the right to number now";
  auto relay_b = OutboxRelay::Start(RelayOptions(), store_b.get(), &publisher_b);

  const auto write_from_both = [&](int64_t first) {
    std::thread other([&] {
      for (int i = 0; i < 20; ++i) {
        EXPECT_OK(testing::AppendEvents(store_b.get(), first + 100 + i * 5, 5));
      }
    });
    for (int i = 0; i < 20; ++i) {
      EXPECT_OK(testing::AppendEvents(store_a.get(), first + i * 5, 5));
    }
    other.join();
  };
  write_from_both(1);
  ASSERT_TRUE(relay_a->WaitForPublished(201, kPatience));
  EXPECT_FALSE(relay_b->active());
  EXPECT_TRUE(publisher_b.events().empty());

  relay_a.reset();
  write_from_both(201);
  ASSERT_TRUE(relay_b->WaitForPublished(401, kPatience));
  EXPECT_TRUE(relay_b->active());

  const std::vector<Event> from_a = publisher_a.events();
  const std::vector<Event> from_b = publisher_b.events();
  std::vector<Event> all = from_a;
  all.insert(all.end(), from_b.begin(), from_b.end());
  ASSERT_EQ(all.size(), 401u);
  std::set<std::string> payloads;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].number, static_cast<int64_t>(i) + 1);
    payloads.insert(all[i].payload);
  }
  EXPECT_EQ(payloads.size(), 401u);
  EXPECT_GT(from_b.front().epoch, from_a.back().epoch);
}

// The database server crashes under a working relay: what was committed is relayed once it is back.
TEST(TwoRelays, ADatabaseCrashLosesNothing) {
  auto cluster = testing::PrivatePostgresql::Start();
  ASSERT_OK(cluster);
  const store::StoreOptions options{.url = (*cluster)->url(), .service = "replicated"};
  auto store = store::OpenStore(options).value();
  RecordingPublisher publisher;
  auto relay = OutboxRelay::Start(RelayOptions(), store.get(), &publisher);
  ASSERT_OK(testing::AppendEvents(store.get(), 0, 10));
  ASSERT_TRUE(relay->WaitForPublished(10, kPatience));
  ASSERT_OK((*cluster)->CrashAndRestart());
  ASSERT_OK(testing::AppendEvents(store.get(), 10, 10));
  ASSERT_TRUE(relay->WaitForPublished(20, kPatience));
  EXPECT_EQ(publisher.events().size(), 20u);
}

}  // namespace
}  // namespace mortise::bus
