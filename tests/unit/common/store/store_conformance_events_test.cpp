// Conformance: the outbox, and gap-free numbers whoever writes and whoever relays.
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/time/time.h"
#include "tests/unit/common/store/store_conformance.h"

namespace mortise::store {
namespace {

class EventConformance : public StoreConformance {
 protected:
  void Append(const std::string& type, const std::string& payload = "") {
    EXPECT_OK(store_->Transact([&](Transaction& transaction) {
      return transaction.AppendEvent(
          {.type = type, .subject = "designs/table", .payload = payload, .trace_id = "t1"});
    }));
  }

  std::vector<NumberedEvent> ReadAll(int64_t after = 0, int limit = 100000) {
    std::vector<NumberedEvent> events;
    EXPECT_OK(store_->Read([&](ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(events, transaction.ReadEvents(after, limit));
      return absl::OkStatus();
    }));
    return events;
  }

  int64_t Latest() {
    int64_t latest = -1;
    EXPECT_OK(store_->Read([&](ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(latest, transaction.LatestEventNumber());
      return absl::OkStatus();
    }));
    return latest;
  }
};
INSTANTIATE_TEST_SUITE_P(Drivers, EventConformance,
                         ::testing::Values(Driver::kSqlite, Driver::kPostgresql), DriverName);

TEST_P(EventConformance, EventsAreSeenOnceNumbered) {
  const absl::Time written = Now();
  Append("design.created", std::string("\0\xFF", 2));
  Append("design.updated");
  EXPECT_TRUE(ReadAll().empty());
  EXPECT_EQ(Latest(), 0);
  Advance(absl::Seconds(9));
  auto numbering = store_->TakeEventNumbering();
  ASSERT_TRUE(numbering.ok()) << numbering.status();
  const std::vector<NumberedEvent> numbered = (*numbering)->NumberEvents(1).value();
  ASSERT_EQ(numbered.size(), 1u);
  ASSERT_EQ((*numbering)->NumberEvents(100)->size(), 1u);
  ASSERT_TRUE((*numbering)->NumberEvents(100)->empty());
  EXPECT_EQ(Latest(), 2);

  const std::vector<NumberedEvent> events = ReadAll();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].number, 1);
  EXPECT_EQ(events[0].epoch, (*numbering)->epoch());
  EXPECT_EQ(events[0].type, "design.created");
  EXPECT_EQ(events[0].subject, "designs/table");
  EXPECT_EQ(events[0].payload, std::string("\0\xFF", 2));
  EXPECT_EQ(events[0].trace_id, "t1");
  EXPECT_EQ(events[0].time, written);
  EXPECT_EQ(events[1].number, 2);
  EXPECT_EQ(numbered[0].payload, events[0].payload);
  EXPECT_EQ(numbered[0].time, events[0].time);
  EXPECT_EQ(ReadAll(1).size(), 1u);
  EXPECT_EQ(ReadAll(0, 1).size(), 1u);
  EXPECT_TRUE(ReadAll(2).empty());
}

TEST_P(EventConformance, OnlyOneNumbersAndATakeoverBeginsAnEpoch) {
  std::unique_ptr<Store> other = OpenAgain();
  auto first = store_->TakeEventNumbering();
  ASSERT_TRUE(first.ok()) << first.status();
  const int64_t first_epoch = (*first)->epoch();
  EXPECT_EQ(DetailOf(other->TakeEventNumbering().status()).reason, "RELAY_TAKEN");
  Append("a");
  ASSERT_EQ((*first)->NumberEvents(10)->size(), 1u);
  first->reset();
  Append("b");

  auto second = other->TakeEventNumbering();
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_GT((*second)->epoch(), first_epoch);
  const std::vector<NumberedEvent> events = (*second)->NumberEvents(10).value();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].number, 2);
}

TEST_P(EventConformance, TheOrderOfOneSubjectIsKept) {
  for (int i = 0; i < 50; ++i) Append("step", std::to_string(i));
  auto numbering = store_->TakeEventNumbering();
  ASSERT_EQ((*numbering)->NumberEvents(7)->size(), 7u);
  ASSERT_EQ((*numbering)->NumberEvents(1000)->size(), 43u);
  const std::vector<NumberedEvent> events = ReadAll();
  for (std::size_t i = 0; i < events.size(); ++i) EXPECT_EQ(events[i].payload, std::to_string(i));
}

// Writers commit in any order, some roll back, while the relay numbers: every committed event gets
// exactly one number, and the numbers are 1 … n.
TEST_P(EventConformance, NumbersHaveNoGapsUnderConcurrentWriters) {
  constexpr int kWriters = 6;
  constexpr int kEach = 60;
  auto numbering = store_->TakeEventNumbering();
  ASSERT_TRUE(numbering.ok());
  std::atomic<int> writing = kWriters;
  std::vector<std::thread> writers;
  for (int w = 0; w < kWriters; ++w) {
    writers.emplace_back([&, w] {
      for (int i = 0; i < kEach; ++i) {
        const absl::Status status = store_->Transact([&](Transaction& transaction) -> absl::Status {
          for (int k = 0; k < 3; ++k) {
            MORTISE_RETURN_IF_ERROR(transaction.AppendEvent(
                {.type = "w", .payload = std::to_string(w * 1'000'000 + i * 10 + k)}));
          }
          std::this_thread::yield();
          return i % 5 == 4 ? absl::CancelledError("rolled back") : absl::OkStatus();
        });
        EXPECT_EQ(status.ok(), i % 5 != 4) << status;
      }
      --writing;
    });
  }
  std::vector<NumberedEvent> relayed;
  while (true) {
    const bool last = writing == 0;
    absl::StatusOr<std::vector<NumberedEvent>> batch = (*numbering)->NumberEvents(50);
    ASSERT_TRUE(batch.ok()) << batch.status();
    relayed.insert(relayed.end(), batch->begin(), batch->end());
    if (last && batch->empty()) break;
  }
  for (std::thread& writer : writers) writer.join();

  constexpr std::size_t kCommitted = kWriters * kEach / 5 * 4 * 3;
  const std::vector<NumberedEvent> stored = ReadAll();
  ASSERT_EQ(relayed.size(), kCommitted);
  ASSERT_EQ(stored.size(), kCommitted);
  std::set<std::string> payloads;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    EXPECT_EQ(stored[i].number, static_cast<int64_t>(i) + 1);
    EXPECT_EQ(relayed[i].number, stored[i].number);
    EXPECT_EQ(relayed[i].payload, stored[i].payload);
    payloads.insert(stored[i].payload);
  }
  EXPECT_EQ(payloads.size(), kCommitted);
}

TEST_P(EventConformance, NumberingGoesOnAfterReopening) {
  Append("a");
  {
    auto numbering = store_->TakeEventNumbering();
    ASSERT_EQ((*numbering)->NumberEvents(10)->size(), 1u);
  }
  Append("b");
  store_.reset();
  store_ = OpenAgain();
  auto numbering = store_->TakeEventNumbering();
  ASSERT_TRUE(numbering.ok()) << numbering.status();
  const std::vector<NumberedEvent> events = (*numbering)->NumberEvents(10).value();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].number, 2);
  EXPECT_EQ(ReadAll().size(), 2u);
}

}  // namespace
}  // namespace mortise::store
