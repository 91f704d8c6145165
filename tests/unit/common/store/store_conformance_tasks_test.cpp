// Conformance: the task queue, its leases and its fencing.
#include <gmock/gmock.h>

#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "tests/unit/common/store/store_conformance.h"

namespace mortise::store {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
constexpr absl::Duration kLease = absl::Seconds(30);

class TaskConformance : public StoreConformance {
 protected:
  absl::Status Do(const std::function<absl::Status(Transaction&)>& change) {
    return store_->Transact(change, Isolation::kReadCommitted);
  }
  absl::Status Enqueue(const NewTask& task) {
    return Do([&](Transaction& transaction) { return transaction.EnqueueTask(task); });
  }
  void EnqueueKeys(const std::vector<std::string>& keys, int max_attempts = 3) {
    for (const std::string& key : keys) {
      EXPECT_OK(Enqueue(
          {.queue = "q", .key = key, .payload = "in-" + key, .max_attempts = max_attempts}));
    }
  }
  LeaseResult Lease(const std::string& worker, int limit = 1) {
    LeaseResult result;
    EXPECT_OK(Do([&](Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(result, transaction.LeaseTasks("q", worker, limit, kLease));
      return absl::OkStatus();
    }));
    return result;
  }
  absl::Status Renew(const std::string& key, int64_t attempt) {
    return Do([&](Transaction& t) { return t.RenewLease("q", key, attempt, kLease); });
  }
  absl::Status Complete(const std::string& key, int64_t attempt, const std::string& result) {
    return Do([&](Transaction& t) { return t.CompleteTask("q", key, attempt, result).status(); });
  }
  absl::Status Fail(const std::string& key, int64_t attempt, bool retry,
                    absl::Duration delay = absl::ZeroDuration()) {
    return Do([&](Transaction& t) { return t.FailTask("q", key, attempt, "no", retry, delay); });
  }
  Task Find(const std::string& key) {
    Task task;
    EXPECT_OK(store_->Read([&](ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(task, transaction.GetTask("q", key));
      return absl::OkStatus();
    }));
    return task;
  }
};
INSTANTIATE_TEST_SUITE_P(Drivers, TaskConformance,
                         ::testing::Values(Driver::kSqlite, Driver::kPostgresql), DriverName);

std::string ReasonOf(const absl::Status& status) { return DetailOf(status).reason; }

std::vector<std::string> Keys(const std::vector<Task>& tasks) {
  std::vector<std::string> keys;
  for (const Task& task : tasks) keys.push_back(task.key);
  return keys;
}

TEST_P(TaskConformance, ATaskGoesFromQueueToResult) {
  EnqueueKeys({"a"});
  EXPECT_EQ(Find("a").state, TaskState::kQueued);
  const Task task = Lease("w1").leased.at(0);
  EXPECT_EQ(task.payload, "in-a");
  EXPECT_EQ(task.attempt, 1);
  EXPECT_EQ(task.worker, "w1");
  EXPECT_EQ(task.state, TaskState::kLeased);
  EXPECT_EQ(task.lease_expires_at, Now() + kLease);
  EXPECT_TRUE(Lease("w2").leased.empty());
  EXPECT_OK(Complete("a", 1, std::string("r\0s", 3)));
  EXPECT_EQ(Find("a").state, TaskState::kSucceeded);
  EXPECT_EQ(Find("a").result, std::string("r\0s", 3));
  EXPECT_OK(Complete("a", 1, "other")) << "repeating is harmless";
  EXPECT_EQ(Find("a").result, std::string("r\0s", 3));
  EXPECT_EQ(ReasonOf(Renew("a", 1)), "TASK_FINISHED");
  EXPECT_EQ(ReasonOf(Fail("a", 1, true)), "TASK_FINISHED");
}

TEST_P(TaskConformance, HigherPriorityFirstThenArrival) {
  EnqueueKeys({"c", "a", "b"});
  EXPECT_OK(Enqueue({.queue = "q", .key = "urgent", .priority = 5}));
  EXPECT_OK(Enqueue({.queue = "q", .key = "idle", .priority = -5}));
  EXPECT_OK(Enqueue({.queue = "elsewhere", .key = "z", .priority = 9}));
  EXPECT_THAT(Keys(Lease("w", 10).leased), ElementsAre("urgent", "c", "a", "b", "idle"));
}

TEST_P(TaskConformance, AKeyIsEnqueuedOnce) {
  EnqueueKeys({"a"});
  EXPECT_EQ(Enqueue({.queue = "q", .key = "a"}).code(), absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(Find("a").payload, "in-a");
  EXPECT_OK(Enqueue({.queue = "q2", .key = "a"}));
}

TEST_P(TaskConformance, ManyAreQueuedInTheirOrderAndOnce) {
  EnqueueKeys({"07", "twice-2"});
  std::vector<NewTask> wanted;
  for (int i = 0; i < 40; ++i) {
    wanted.push_back({.queue = i == 39 ? "q2" : "q",
                      .key = absl::StrFormat("%02d", i),
                      .payload = std::string("in\0-", 4) + std::to_string(i)});
  }
  wanted.push_back({.queue = "q", .key = "twice", .payload = "first"});
  wanted.push_back({.queue = "q", .key = "twice", .payload = "second"});
  std::vector<bool> queued;
  const auto enqueue = [&] {
    return Do([&](Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(queued, transaction.EnqueueTasks(wanted));
      return absl::OkStatus();
    });
  };
  EXPECT_OK(enqueue());
  ASSERT_EQ(queued.size(), wanted.size());
  for (std::size_t i = 0; i < queued.size(); ++i) EXPECT_EQ(queued[i], i != 7 && i != 41) << i;
  EXPECT_EQ(Find("12").payload, std::string("in\0-", 4) + "12");
  EXPECT_EQ(Find("07").payload, "in-07");
  EXPECT_EQ(Find("twice").payload, "first");
  EXPECT_THAT(Keys(Lease("w", 5).leased), ElementsAre("07", "twice-2", "00", "01", "02"));
  EXPECT_OK(enqueue());
  EXPECT_THAT(queued, Each(false));
  wanted[20].max_attempts = 0;
  wanted[0].key = "new";
  EXPECT_EQ(DetailOf(enqueue()).field, "max_attempts");
  EXPECT_EQ(Do([&](Transaction& t) { return t.GetTask("q", "new").status(); }).code(),
            absl::StatusCode::kNotFound);
}

TEST_P(TaskConformance, AStaleAttemptIsRefused) {
  EnqueueKeys({"a"});
  ASSERT_EQ(Lease("w1").leased.at(0).attempt, 1);
  Advance(kLease + absl::Seconds(1));
  ASSERT_EQ(Lease("w2").leased.at(0).attempt, 2);
  EXPECT_EQ(ReasonOf(Complete("a", 1, "late")), "STALE_ATTEMPT");
  EXPECT_EQ(ReasonOf(Renew("a", 1)), "STALE_ATTEMPT");
  EXPECT_EQ(ReasonOf(Fail("a", 1, true)), "STALE_ATTEMPT");
  EXPECT_EQ(ReasonOf(Complete("a", 7, "future")), "STALE_ATTEMPT");
  EXPECT_OK(Complete("a", 2, "right"));
  EXPECT_EQ(ReasonOf(Complete("a", 1, "late")), "STALE_ATTEMPT");
  EXPECT_EQ(Find("a").result, "right");
}

TEST_P(TaskConformance, ALateResultThatNobodyReplacedCounts) {
  EnqueueKeys({"a"});
  Lease("w1");
  Advance(kLease * 2);
  EXPECT_OK(Complete("a", 1, "late"));
  EXPECT_EQ(Find("a").result, "late");
}

TEST_P(TaskConformance, RenewingKeepsTheLease) {
  EnqueueKeys({"a"});
  Lease("w1");
  for (int i = 0; i < 5; ++i) {
    Advance(kLease * 0.7);
    EXPECT_OK(Renew("a", 1));
    EXPECT_TRUE(Lease("w2").leased.empty());
  }
}

TEST_P(TaskConformance, ATaskWhoseWorkersVanishIsQuarantinedWithItsInput) {
  EnqueueKeys({"killer"});
  for (int attempt = 1; attempt <= 3; ++attempt) {
    const LeaseResult result = Lease("w");
    ASSERT_EQ(result.leased.size(), 1u);
    EXPECT_EQ(result.leased[0].attempt, attempt);
    EXPECT_TRUE(result.quarantined.empty());
    Advance(kLease + absl::Seconds(1));
  }
  const LeaseResult result = Lease("w", 0);
  EXPECT_TRUE(result.leased.empty());
  ASSERT_THAT(Keys(result.quarantined), ElementsAre("killer"));
  EXPECT_TRUE(Lease("w").quarantined.empty()) << "told once";
  const Task task = Find("killer");
  EXPECT_EQ(task.state, TaskState::kQuarantined);
  EXPECT_EQ(task.payload, "in-killer");
  EXPECT_FALSE(task.error.empty());
  EXPECT_EQ(ReasonOf(Complete("killer", 3, "too late")), "TASK_FINISHED");
}

// Three workers die of the first of the tasks that they hold: the others are as good as new.
TEST_P(TaskConformance, WhatAWorkerHeldInReserveLosesNoAttempt) {
  EnqueueKeys({"killer", "b", "c"});
  for (const char* worker : {"w1", "w2", "w3"}) {
    EXPECT_THAT(Keys(Lease(worker, 3).leased), ElementsAre("killer", "b", "c"));
    Advance(kLease + absl::Seconds(1));
  }
  LeaseResult result = Lease("w4", 3);
  EXPECT_THAT(Keys(result.quarantined), ElementsAre("killer"));
  EXPECT_THAT(Keys(result.leased), ElementsAre("b", "c"));
  // Three attempts at b count from here; what is done is not held.
  EXPECT_OK(Complete("b", 4, "done"));
  for (const char* worker : {"w5", "w6"}) {
    Advance(kLease + absl::Seconds(1));
    EXPECT_THAT(Keys(Lease(worker, 3).leased), ElementsAre("c"));
  }
  Advance(kLease + absl::Seconds(1));
  EXPECT_THAT(Keys(Lease("w7", 3).quarantined), ElementsAre("c"));
}

// What was leased first was begun first, whatever its place in the queue.
TEST_P(TaskConformance, TheFirstLeaseOfAWorkerCounts) {
  EnqueueKeys({"a", "b"}, 1);
  Lease("w1", 1);  // a
  Advance(absl::Seconds(1));
  Lease("w2", 1);  // b
  Advance(absl::Seconds(1));
  EXPECT_OK(Do([&](Transaction& t) { return t.ReleaseTask("q", "a", 1); }));
  Lease("w2", 1);  // a, in reserve
  Advance(kLease + absl::Seconds(1));
  const LeaseResult result = Lease("w3", 2);
  EXPECT_THAT(Keys(result.quarantined), ElementsAre("b"));
  EXPECT_THAT(Keys(result.leased), ElementsAre("a"));
}

TEST_P(TaskConformance, AFailureIsRetriedAfterItsDelayUntilAttemptsAreUsedUp) {
  EnqueueKeys({"a"}, 2);
  Lease("w");
  EXPECT_OK(Fail("a", 1, true, absl::Seconds(10)));
  EXPECT_OK(Fail("a", 1, true, absl::Seconds(10))) << "repeating is harmless";
  EXPECT_EQ(ReasonOf(Complete("a", 1, "after failing")), "STALE_ATTEMPT");
  EXPECT_EQ(Find("a").error, "no");
  EXPECT_TRUE(Lease("w").leased.empty());
  Advance(absl::Seconds(10));
  EXPECT_EQ(Lease("w").leased.at(0).attempt, 2);
  EXPECT_OK(Fail("a", 2, true));
  EXPECT_EQ(Find("a").state, TaskState::kFailed);
  EnqueueKeys({"b"});
  Lease("w");
  EXPECT_OK(Fail("b", 1, false));
  EXPECT_EQ(Find("b").state, TaskState::kFailed);
}

TEST_P(TaskConformance, AReleasedTaskLosesNoAttempt) {
  EnqueueKeys({"a"}, 1);
  for (int attempt = 1; attempt <= 4; ++attempt) {
    ASSERT_EQ(Lease("w").leased.at(0).attempt, attempt);
    EXPECT_OK(Do([&](Transaction& t) { return t.ReleaseTask("q", "a", attempt); }));
    EXPECT_EQ(ReasonOf(Complete("a", attempt, "x")), "STALE_ATTEMPT");
  }
}

TEST_P(TaskConformance, AWorkerThatRestartsGetsItsTasksAtOnce) {
  EnqueueKeys({"a", "b", "c"});
  Lease("w1", 2);
  Lease("w2", 1);
  EXPECT_OK(Do([&](Transaction& transaction) -> absl::Status {
    EXPECT_EQ(transaction.ExpireLeases("q", "w1").value(), 2);
    return absl::OkStatus();
  }));
  EXPECT_THAT(Keys(Lease("w1", 10).leased), ElementsAre("a", "b"));
}

TEST_P(TaskConformance, ACancelledTaskIsNotRun) {
  const auto cancel = [&](const std::string& key) {
    return Do([&](Transaction& t) { return t.CancelTask("q", key); });
  };
  EnqueueKeys({"a", "b"});
  EXPECT_OK(cancel("a"));
  EXPECT_OK(cancel("a"));
  EXPECT_THAT(Keys(Lease("w", 10).leased), ElementsAre("b"));
  EXPECT_OK(cancel("b"));
  EXPECT_EQ(ReasonOf(Renew("b", 1)), "TASK_CANCELLED");
  EXPECT_EQ(ReasonOf(Complete("b", 1, "x")), "TASK_CANCELLED");
  Advance(kLease * 2);
  EXPECT_TRUE(Lease("w", 10).leased.empty());
  EnqueueKeys({"c"});
  Lease("w");
  EXPECT_OK(Complete("c", 1, "x"));
  EXPECT_EQ(ReasonOf(cancel("c")), "TASK_FINISHED");
  EXPECT_EQ(cancel("nothing").code(), absl::StatusCode::kNotFound);
}

TEST_P(TaskConformance, DepthListAndDelete) {
  EnqueueKeys({"a", "b", "c", "d"});
  Lease("w", 2);
  EXPECT_OK(Complete("a", 1, "x"));
  EXPECT_OK(Do([&](Transaction& t) { return t.CancelTask("q", "d"); }));
  EXPECT_OK(store_->Read([](ReadTransaction& transaction) -> absl::Status {
    const QueueDepth depth = transaction.Depth("q").value();
    EXPECT_EQ(depth.queued, 1);
    EXPECT_EQ(depth.leased, 1);
    EXPECT_EQ(depth.succeeded, 1);
    EXPECT_EQ(depth.cancelled, 1);
    EXPECT_EQ(depth.failed + depth.quarantined, 0);
    EXPECT_THAT(Keys(*transaction.ListTasks("q", {.after_key = "a", .limit = 2})),
                ElementsAre("b", "c"));
    return absl::OkStatus();
  }));
  const auto remove = [&](const std::string& key) {
    return Do([&](Transaction& t) { return t.DeleteTask("q", key); });
  };
  EXPECT_OK(remove("a"));
  EXPECT_EQ(ReasonOf(remove("b")), "TASK_UNFINISHED");
  EXPECT_EQ(remove("a").code(), absl::StatusCode::kNotFound);
  EXPECT_OK(Enqueue({.queue = "q", .key = "a"}));
}

// Eight workers on two stores: every task is leased once, and every completion counts once.
TEST_P(TaskConformance, NoTaskIsLeasedTwice) {
  constexpr int kTasks = 400;
  std::unique_ptr<Store> other = OpenAgain();
  EXPECT_OK(Do([&](Transaction& transaction) -> absl::Status {
    for (int i = 0; i < kTasks; ++i) {
      MORTISE_RETURN_IF_ERROR(transaction.EnqueueTask({.queue = "q", .key = std::to_string(i)}));
    }
    return absl::OkStatus();
  }));
  std::mutex mutex;
  std::map<std::string, int> leases;
  std::vector<std::thread> workers;
  for (int w = 0; w < 8; ++w) {
    workers.emplace_back([&, w] {
      Store* mine = w % 2 == 0 ? store_.get() : other.get();
      const std::string name = "w" + std::to_string(w);
      while (true) {
        LeaseResult result;
        EXPECT_OK(mine->Transact(
            [&](Transaction& transaction) -> absl::Status {
              MORTISE_ASSIGN_OR_RETURN(result, transaction.LeaseTasks("q", name, 3, kLease));
              return absl::OkStatus();
            },
            Isolation::kReadCommitted));
        if (result.leased.empty()) return;
        for (const Task& task : result.leased) {
          {
            std::lock_guard lock(mutex);
            ++leases[task.key];
          }
          EXPECT_OK(mine->Transact(
              [&](Transaction& transaction) {
                return transaction.CompleteTask("q", task.key, task.attempt, name).status();
              },
              Isolation::kReadCommitted));
        }
      }
    });
  }
  for (std::thread& worker : workers) worker.join();
  EXPECT_EQ(leases.size(), static_cast<std::size_t>(kTasks));
  for (const auto& [key, count] : leases) EXPECT_EQ(count, 1) << key;
  EXPECT_OK(store_->Read([&](ReadTransaction& transaction) -> absl::Status {
    EXPECT_EQ(transaction.Depth("q")->succeeded, kTasks);
    return absl::OkStatus();
  }));
}

// Serializable transactions that also touch the queue must not livelock one another.
TEST_P(TaskConformance, SerializableQueueUseMakesProgress) {
  EnqueueKeys({"a", "b", "c", "d", "e", "f", "g", "h"});
  std::atomic<int> completed = 0;
  std::vector<std::thread> workers;
  for (int w = 0; w < 4; ++w) {
    workers.emplace_back([&, w] {
      for (int i = 0; i < 2; ++i) {
        std::vector<Task> leased;
        EXPECT_OK(store_->Transact([&](Transaction& transaction) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(LeaseResult result,
                                   transaction.LeaseTasks("q", "w" + std::to_string(w), 1, kLease));
          leased = std::move(result.leased);
          return absl::OkStatus();
        }));
        for (const Task& task : leased) {
          EXPECT_OK(store_->Transact([&](Transaction& transaction) -> absl::Status {
            MORTISE_RETURN_IF_ERROR(transaction.Put("results", task.key, "r").status());
            MORTISE_RETURN_IF_ERROR(transaction.AppendEvent({.type = "task.done"}));
            return transaction.CompleteTask("q", task.key, task.attempt, "r").status();
          }));
          ++completed;
        }
      }
    });
  }
  for (std::thread& worker : workers) worker.join();
  EXPECT_EQ(completed, 8);
}

TEST_P(TaskConformance, BadInputNamesTheField) {
  const auto field = [](const absl::Status& status) {
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  EXPECT_EQ(field(Enqueue({.queue = "", .key = "a"})), "queue");
  EXPECT_EQ(field(Enqueue({.queue = "q", .key = ""})), "key");
  EXPECT_EQ(field(Enqueue({.queue = "q", .key = "a", .max_attempts = 0})), "max_attempts");
  EXPECT_OK(Do([&](Transaction& t) -> absl::Status {
    EXPECT_EQ(field(t.LeaseTasks("q", "", 1, kLease).status()), "worker");
    EXPECT_EQ(field(t.LeaseTasks("q", "w", -1, kLease).status()), "limit");
    EXPECT_EQ(field(t.LeaseTasks("q", "w", 1, absl::ZeroDuration()).status()), "lease");
    EXPECT_EQ(field(t.LeaseTasks("q", "w", 1, absl::InfiniteDuration()).status()), "lease");
    EXPECT_EQ(field(t.FailTask("q", "a", 1, "e", true, -absl::Seconds(1))), "delay");
    return absl::OkStatus();
  }));
  EXPECT_EQ(Complete("nothing", 1, "x").code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace mortise::store
