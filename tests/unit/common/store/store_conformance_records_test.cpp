// Conformance: records, revisions, history, listing and transactions.
#include <gmock/gmock.h>

#include <string>
#include <thread>
#include <vector>

#include "tests/unit/common/store/store_conformance.h"

namespace mortise::store {
namespace {

using ::testing::ElementsAre;
using RecordConformance = StoreConformance;
INSTANTIATE_TEST_SUITE_P(Drivers, RecordConformance,
                         ::testing::Values(Driver::kSqlite, Driver::kPostgresql), DriverName);

std::vector<std::string> Keys(const std::vector<Record>& records) {
  std::vector<std::string> keys;
  for (const Record& record : records) keys.push_back(record.key);
  return keys;
}

TEST_P(RecordConformance, PutThenGetGivesTheSameBytes) {
  std::string bytes;
  for (int i = 0; i < 1024; ++i) bytes.push_back(static_cast<char>(i * 7));
  ASSERT_EQ(Put("designs", "table", bytes).value(), 1);
  const Record record = Get("designs", "table").value();
  EXPECT_EQ(record.kind, "designs");
  EXPECT_EQ(record.key, "table");
  EXPECT_EQ(record.revision, 1);
  EXPECT_EQ(record.payload, bytes);
  EXPECT_EQ(record.created_at, Now());
}

TEST_P(RecordConformance, RevisionsCountFromOneAndTimesFollow) {
  const absl::Time created = Now();
  ASSERT_EQ(Put("designs", "table", "a").value(), 1);
  Advance(absl::Seconds(5));
  ASSERT_EQ(Put("designs", "table", "").value(), 2);
  const Record record = Get("designs", "table").value();
  EXPECT_EQ(record.payload, "");
  EXPECT_EQ(record.created_at, created);
  EXPECT_EQ(record.updated_at, Now());
}

TEST_P(RecordConformance, ExpectedRevisionIsChecked) {
  ASSERT_EQ(Put("designs", "table", "a", {.expected_revision = 0}).value(), 1);
  const absl::Status exists = Put("designs", "table", "b", {.expected_revision = 0}).status();
  EXPECT_EQ(exists.code(), absl::StatusCode::kAborted);
  EXPECT_EQ(DetailOf(exists).reason, "STALE_REVISION");
  EXPECT_EQ(DetailOf(exists).field, "designs/table");
  ASSERT_EQ(Put("designs", "table", "b", {.expected_revision = 1}).value(), 2);
  EXPECT_EQ(DetailOf(Put("designs", "table", "c", {.expected_revision = 1}).status()).reason,
            "STALE_REVISION");
  EXPECT_EQ(DetailOf(Put("designs", "chair", "c", {.expected_revision = 4}).status()).reason,
            "STALE_REVISION");
  EXPECT_EQ(Get("designs", "table")->payload, "b");
}

TEST_P(RecordConformance, KeptRevisionsStayReadable) {
  ASSERT_EQ(Put("designs", "table", "one").value(), 1);
  ASSERT_EQ(Put("designs", "table", "two", {.keep_history = true}).value(), 2);
  ASSERT_EQ(Put("designs", "table", "three").value(), 3);
  ASSERT_EQ(Put("designs", "table", "four", {.keep_history = true}).value(), 4);
  EXPECT_OK(store_->Read([](ReadTransaction& transaction) -> absl::Status {
    EXPECT_EQ(transaction.GetRevision("designs", "table", 1)->payload, "one");
    EXPECT_EQ(transaction.GetRevision("designs", "table", 3)->payload, "three");
    EXPECT_EQ(transaction.GetRevision("designs", "table", 4)->payload, "four");
    const absl::Status gone = transaction.GetRevision("designs", "table", 2).status();
    EXPECT_EQ(gone.code(), absl::StatusCode::kNotFound);
    EXPECT_EQ(DetailOf(gone).field, "designs/table/revisions/2");
    return absl::OkStatus();
  }));
}

TEST_P(RecordConformance, DeleteRemovesRecordAndHistory) {
  ASSERT_TRUE(Put("designs", "table", "one").ok());
  ASSERT_TRUE(Put("designs", "table", "two", {.keep_history = true}).ok());
  const auto remove = [&](std::optional<int64_t> revision) {
    return store_->Transact(
        [&](Transaction& transaction) { return transaction.Delete("designs", "table", revision); });
  };
  EXPECT_EQ(DetailOf(remove(1)).reason, "STALE_REVISION");
  EXPECT_OK(remove(2));
  EXPECT_EQ(remove(std::nullopt).code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(Get("designs", "table").status().code(), absl::StatusCode::kNotFound);
  ASSERT_EQ(Put("designs", "table", "new", {.keep_history = true}).value(), 1);
  ASSERT_EQ(Put("designs", "table", "newer", {.keep_history = true}).value(), 2);
}

TEST_P(RecordConformance, ListsInByteOrderByPages) {
  for (const char* key : {"b", "a-1", "a", "a-10", "a-2", "B", "é", "a_"}) {
    ASSERT_TRUE(Put("items", key, key).ok());
  }
  ASSERT_TRUE(Put("other", "a-0", "x").ok());
  EXPECT_OK(store_->Read([](ReadTransaction& transaction) -> absl::Status {
    EXPECT_THAT(Keys(*transaction.List("items", {})),
                ElementsAre("B", "a", "a-1", "a-10", "a-2", "a_", "b", "é"));
    EXPECT_THAT(Keys(*transaction.List("items", {.key_prefix = "a-"})),
                ElementsAre("a-1", "a-10", "a-2"));
    EXPECT_THAT(
        Keys(*transaction.List("items", {.after_key = "a-1", .key_prefix = "a", .limit = 2})),
        ElementsAre("a-10", "a-2"));
    EXPECT_THAT(Keys(*transaction.List("items", {.after_key = "é"})), ElementsAre());
    EXPECT_THAT(Keys(*transaction.List("items", {.limit = 3, .descending = true})),
                ElementsAre("é", "b", "a_"));
    EXPECT_THAT(Keys(*transaction.List(
                    "items", {.after_key = "a-2", .key_prefix = "a-", .descending = true})),
                ElementsAre("a-10", "a-1"));
    EXPECT_THAT(Keys(*transaction.List("nothing", {})), ElementsAre());
    return absl::OkStatus();
  }));
}

TEST_P(RecordConformance, AFailedTransactionLeavesNothing) {
  const absl::Status status = store_->Transact([](Transaction& transaction) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(transaction.Put("designs", "table", "x").status());
    MORTISE_RETURN_IF_ERROR(transaction.AppendEvent({.type = "design.created"}));
    MORTISE_RETURN_IF_ERROR(transaction.EnqueueTask({.queue = "q", .key = "k"}));
    transaction.AfterCommit([] { ADD_FAILURE() << "nothing was committed"; });
    EXPECT_TRUE(transaction.Get("designs", "table").ok());  // its own writes are seen inside
    return InvalidField("height", "too high");
  });
  EXPECT_EQ(DetailOf(status).field, "height");
  EXPECT_EQ(Get("designs", "table").status().code(), absl::StatusCode::kNotFound);
  EXPECT_OK(store_->Read([](ReadTransaction& transaction) -> absl::Status {
    EXPECT_EQ(transaction.Depth("q")->queued, 0);
    return absl::OkStatus();
  }));
  auto numbering = store_->TakeEventNumbering();
  ASSERT_TRUE(numbering.ok()) << numbering.status();
  EXPECT_TRUE((*numbering)->NumberEvents(10)->empty());
}

TEST_P(RecordConformance, ListsWithoutPayloads) {
  const std::string payload(3'000'000, 'x');
  ASSERT_EQ(Put("items", "a", "first").value(), 1);
  ASSERT_EQ(Put("items", "a", payload).value(), 2);
  ASSERT_EQ(Put("items", "b", "b").value(), 1);
  EXPECT_OK(store_->Read([&](ReadTransaction& transaction) -> absl::Status {
    for (const bool descending : {false, true}) {
      const auto bare = transaction.List(
          "items", {.limit = 2, .descending = descending, .without_payloads = true});
      const auto whole = transaction.List("items", {.limit = 2, .descending = descending});
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ((*bare)[i].payload, "");
        EXPECT_EQ((*bare)[i].key, (*whole)[i].key);
        EXPECT_EQ((*bare)[i].revision, (*whole)[i].revision);
        EXPECT_EQ((*bare)[i].updated_at, (*whole)[i].updated_at);
      }
      EXPECT_TRUE((*whole)[descending ? 1 : 0].payload == payload);
    }
    return absl::OkStatus();
  }));
}

TEST_P(RecordConformance, AfterCommitMayUseTheStoreAndListenersHear) {
  int heard = 0;
  auto listener = store_->OnCommit([&] { ++heard; });
  std::string seen;
  EXPECT_OK(store_->Transact([&](Transaction& transaction) -> absl::Status {
    transaction.AfterCommit([&] { seen = Get("designs", "table")->payload; });
    MORTISE_RETURN_IF_ERROR(transaction.AppendEvent({.type = "design.created"}));
    return transaction.Put("designs", "table", "x").status();
  }));
  EXPECT_EQ(seen, "x");
  EXPECT_EQ(heard, 1);
  ASSERT_TRUE(Put("designs", "table", "y").ok());
  EXPECT_EQ(heard, 1) << "neither an event nor a task";
  listener.reset();
  EXPECT_OK(store_->Transact([](Transaction& transaction) {
    return transaction.EnqueueTask({.queue = "q", .key = "k"});
  }));
  EXPECT_EQ(heard, 1);
}

TEST_P(RecordConformance, TransactionsDoNotNest) {
  const absl::Status status = store_->Transact([&](Transaction&) {
    return store_->Transact([](Transaction&) { return absl::OkStatus(); });
  });
  EXPECT_EQ(DetailOf(status).reason, "TRANSACTION_NESTED");
  EXPECT_TRUE(Put("designs", "table", "y").ok()) << "the store works on";
}

TEST_P(RecordConformance, AnExceptionRollsBack) {
  EXPECT_THROW(store_
                   ->Transact([](Transaction& transaction) -> absl::Status {
                     transaction.Put("designs", "table", "x").IgnoreError();
                     throw std::runtime_error("a library's");
                   })
                   .IgnoreError(),
               std::runtime_error);
  EXPECT_EQ(Get("designs", "table").status().code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(Put("designs", "table", "y").ok());
}

// Reading, then writing what was read plus one, must lose no update under concurrent writers.
TEST_P(RecordConformance, ConcurrentIncrementsAreAllCounted) {
  constexpr int kThreads = 6;
  constexpr int kEach = 25;
  std::vector<std::unique_ptr<Store>> stores;
  for (int i = 0; i < 2; ++i) stores.push_back(OpenAgain());
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kEach; ++i) {
        EXPECT_OK(stores[static_cast<std::size_t>(t % 2)]->Transact(
            [](Transaction& transaction) -> absl::Status {
              absl::StatusOr<Record> record = transaction.Get("counters", "c");
              if (!record.ok() && !absl::IsNotFound(record.status())) return record.status();
              const int value = record.ok() ? std::stoi(record->payload) : 0;
              return transaction.Put("counters", "c", std::to_string(value + 1)).status();
            }));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(Get("counters", "c")->payload, std::to_string(kThreads * kEach));
}

// "Create unless it exists", the shape of every idempotent request, from many at once.
TEST_P(RecordConformance, OfManyCreatorsOneWins) {
  std::atomic<int> created = 0;
  std::atomic<int> stale = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      absl::StatusOr<int64_t> revision = Put("requests", "r1", "x", {.expected_revision = 0});
      if (revision.ok()) ++created;
      if (DetailOf(revision.status()).reason == "STALE_REVISION") ++stale;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(created, 1);
  EXPECT_EQ(stale, 7);
}

TEST_P(RecordConformance, AReadSeesOneState) {
  ASSERT_TRUE(Put("designs", "table", "old").ok());
  EXPECT_OK(store_->Read([&](ReadTransaction& transaction) -> absl::Status {
    EXPECT_EQ(transaction.Get("designs", "table")->payload, "old");
    std::thread([&] { EXPECT_TRUE(Put("designs", "table", "new").ok()); }).join();
    EXPECT_EQ(transaction.Get("designs", "table")->payload, "old");
    return absl::OkStatus();
  }));
  EXPECT_EQ(Get("designs", "table")->payload, "new");
}

TEST_P(RecordConformance, WhatWasCommittedIsThereAfterReopening) {
  ASSERT_TRUE(Put("designs", "table", "x", {.keep_history = true}).ok());
  store_.reset();
  store_ = OpenAgain();
  EXPECT_EQ(Get("designs", "table")->payload, "x");
}

TEST_P(RecordConformance, BadNamesAndLimitsNameTheField) {
  const auto field = [](const absl::Status& status) {
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  EXPECT_EQ(field(Put("", "k", "x").status()), "kind");
  EXPECT_EQ(field(Put("designs", "", "x").status()), "key");
  EXPECT_EQ(field(Put("designs", std::string("a\0b", 3), "x").status()), "key");
  EXPECT_EQ(field(Put("designs", "a\nb", "x").status()), "key");
  EXPECT_EQ(field(Put("designs", "\xC3", "x").status()), "key");
  EXPECT_EQ(field(Put("designs", "\xED\xA0\x80", "x").status()), "key");  // a surrogate
  EXPECT_EQ(field(Put("designs", "\xC0\xAF", "x").status()), "key");      // overlong
  EXPECT_EQ(field(Put("designs", std::string(1025, 'x'), "x").status()), "key");
  EXPECT_OK(store_->Read([&](ReadTransaction& transaction) -> absl::Status {
    EXPECT_EQ(field(transaction.List("designs", {.limit = 0}).status()), "limit");
    EXPECT_EQ(field(transaction.List("designs", {.limit = -1}).status()), "limit");
    EXPECT_EQ(field(transaction.ReadEvents(0, 1 << 30).status()), "limit");
    return absl::OkStatus();
  }));
  EXPECT_EQ(Put("designs", "k", std::string((std::size_t{64} << 20) + 1, 'x')).status().code(),
            absl::StatusCode::kResourceExhausted);
}

}  // namespace
}  // namespace mortise::store
