// How fast events travel from the outbox to a subscriber, and how fast a stream is replayed.
//
//   bus_bench [--seconds=5] [--events=1000000]
//
// The sustained run writes 100 transactions a second of 500 events of 200 bytes to an SQLite store
// (WAL, synchronous=NORMAL) while relay, broker and subscriber run in the same process. The replay
// begins at number 0. Both end with an error if an event is missing or out of order.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "tests/support/house_bus.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace mortise;

constexpr int kTransaction = 500;   // events
constexpr int64_t kRate = 50'000;   // events a second
constexpr std::size_t kSize = 200;  // bytes a payload

[[noreturn]] void Fail(const std::string& why) {
  std::fprintf(stderr, "bus_bench: %s\n", why.c_str());
  std::exit(1);
}

void Check(const absl::Status& status) {
  if (!status.ok()) Fail(status.ToString());
}

absl::Status WriteTransaction(store::Store* store, const std::string& payload) {
  return store->Transact([&](store::Transaction& transaction) -> absl::Status {
    for (int i = 0; i < kTransaction; ++i) {
      absl::Status status = transaction.AppendEvent(
          {.type = "cut.finished", .subject = "workOrders/w1", .payload = payload});
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  });
}

// Follows the stream and checks that the numbers come without gaps.
class Follower {
 public:
  Follower(store::Store* store, const std::string& endpoint) {
    bus::ReplayOptions options;
    options.endpoint = endpoint;
    options.cursors = {{"bench", 0}};
    options.fetch = testing::FetchFrom(store);
    options.fetch_limit = 5000;
    options.handle = [this](std::span<const bus::Event> events) {
      for (const bus::Event& event : events) {
        if (event.number != ++last_) Fail("a number is missing");
      }
      worst_delay_ = std::max(worst_delay_, absl::Now() - events.front().time);
      return absl::OkStatus();
    };
    subscriber_ = bus::ReplayingSubscriber::Start(options).value();
  }

  bus::ReplayingSubscriber* operator->() { return subscriber_.get(); }
  absl::Duration worst_delay() const { return worst_delay_; }

 private:
  int64_t last_ = 0;
  absl::Duration worst_delay_ = absl::ZeroDuration();
  std::unique_ptr<bus::ReplayingSubscriber> subscriber_;
};

struct House {
  House()
      : store(store::OpenStore({.url = "sqlite:" + (folder.path() / "s.db").string()}).value()),
        broker(testing::StartBroker()),
        publisher(bus::Publisher::Connect({.endpoint = broker->publisher_endpoint()}).value()) {}

  testing::TemporaryFolder folder;
  std::unique_ptr<store::Store> store;
  std::unique_ptr<bus::Broker> broker;
  std::unique_ptr<bus::Publisher> publisher;
};

void Sustained(int seconds) {
  House house;
  const std::string payload(kSize, 'x');
  auto relay =
      bus::OutboxRelay::Start({.stream = "bench"}, house.store.get(), house.publisher.get());
  Follower follower(house.store.get(), house.broker->subscriber_endpoint());
  const int64_t total = kRate * seconds;
  const absl::Time start = absl::Now();
  for (int64_t written = 0; written < total; written += kTransaction) {
    Check(WriteTransaction(house.store.get(), payload));
    const absl::Time due = start + absl::Seconds(1) * (static_cast<double>(written) / kRate);
    if (const absl::Duration early = due - absl::Now(); early > absl::ZeroDuration()) {
      absl::SleepFor(early);
    }
  }
  const double writing = absl::ToDoubleSeconds(absl::Now() - start);
  if (!follower->WaitFor("bench", total, absl::Seconds(60 + seconds))) Fail("events are missing");
  const double all = absl::ToDoubleSeconds(absl::Now() - start);
  const double fetched = static_cast<double>(follower->fetched()) / static_cast<double>(total);
  std::printf(
      "bus sustained: %lld events of %zu bytes, written at %.0f/s, delivered at %.0f/s, "
      "target %lld/s (ratio %.2f), %.1f %% fetched by number, worst delay %.0f ms\n",
      static_cast<long long>(total), kSize, static_cast<double>(total) / writing,
      static_cast<double>(total) / all, static_cast<long long>(kRate),
      static_cast<double>(total) / all / kRate, 100 * fetched,
      absl::ToDoubleMilliseconds(follower.worst_delay()));
}

void Replay(int64_t total) {
  House house;
  const std::string payload(kSize, 'x');
  absl::Time start = absl::Now();
  for (int64_t written = 0; written < total; written += kTransaction) {
    Check(WriteTransaction(house.store.get(), payload));
  }
  const double writing = absl::ToDoubleSeconds(absl::Now() - start);
  auto relay =
      bus::OutboxRelay::Start({.stream = "bench"}, house.store.get(), house.publisher.get());
  start = absl::Now();
  if (!relay->WaitForPublished(total, absl::Minutes(5))) Fail("the relay is too slow");
  const double relaying = absl::ToDoubleSeconds(absl::Now() - start);
  start = absl::Now();
  Follower follower(house.store.get(), house.broker->subscriber_endpoint());
  if (!follower->WaitFor("bench", total, absl::Minutes(5))) Fail("events are missing");
  const double replaying = absl::ToDoubleSeconds(absl::Now() - start);
  std::printf(
      "bus replay: %lld events in order, none missing, in %.1f s (%.0f/s); written at "
      "%.0f/s, relayed at %.0f/s\n",
      static_cast<long long>(total), replaying, static_cast<double>(total) / replaying,
      static_cast<double>(total) / writing, static_cast<double>(total) / relaying);
}

}  // namespace

int main(int argc, char** argv) {
  int seconds = 5;
  long long events = 1'000'000;
  for (int i = 1; i < argc; ++i) {
    if (std::sscanf(argv[i], "--seconds=%d", &seconds) == 1) continue;
    if (std::sscanf(argv[i], "--events=%lld", &events) == 1) continue;
    Fail("options are --seconds=N and --events=N");
  }
  Sustained(seconds);
  Replay(events);
  return 0;
}
