// Operations on both store drivers: life cycle, cancelling, progress, resuming, replicas.
#include "common/operations/operations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/store/postgresql_connection.h"
#include "tests/support/private_postgresql.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::jobs {
namespace {

using ::testing::ElementsAre;

enum class Driver { kSqlite, kPostgresql };

const std::string& SharedPostgresqlUrl() {
  static const auto cluster = testing::PrivatePostgresql::Start();
  static const std::string url = cluster.ok() ? (*cluster)->url() : "";
  if (!cluster.ok()) ADD_FAILURE() << cluster.status();
  return url;
}

// Lets one thread wait until another says so.
class Gate {
 public:
  void Open() {
    std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void Pass() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return open_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
};

// Runs until told to stop.
absl::StatusOr<std::string> RunUntilStopped(OperationContext& context) {
  std::mutex mutex;
  std::condition_variable_any nothing;
  std::unique_lock lock(mutex);
  nothing.wait(lock, context.stop_token(), [] { return false; });
  EXPECT_TRUE(context.Cancelled());
  return absl::CancelledError("stopped");
}

class OperationsTest : public ::testing::TestWithParam<Driver> {
 protected:
  void SetUp() override {
    static std::atomic<int> last_service = 0;
    service_ = "jobs-" + std::to_string(++last_service);
    if (GetParam() == Driver::kPostgresql) SharedPostgresqlUrl();
    store_ = OpenStoreAgain();
    ASSERT_NE(store_, nullptr);
  }

  // Ends every connection to the server, if there is one.
  static void LoseDatabase() {
    if (GetParam() != Driver::kPostgresql) return;
    const auto other = store::PostgresqlConnection::Open(SharedPostgresqlUrl(), "public");
    ASSERT_OK(other);
    EXPECT_OK(
        (*other)->Execute("SELECT pg_terminate_backend(pid) FROM pg_stat_activity"
                          " WHERE pid <> pg_backend_pid() AND"
                          " backend_type = 'client backend'"));
  }

  std::unique_ptr<store::Store> OpenStoreAgain() {
    store::StoreOptions options;
    options.url = GetParam() == Driver::kSqlite ? "sqlite:" + (folder_.path() / "store.db").string()
                                                : SharedPostgresqlUrl();
    options.service = service_;
    options.clock = [this] { return absl::Now() + absl::Microseconds(ahead_.load()); };
    auto store = store::OpenStore(options);
    EXPECT_OK(store);
    return store.ok() ? *std::move(store) : nullptr;
  }

  OperationsOptions Options() const {
    OperationsOptions options;
    options.service = "pareto";
    options.lease = absl::Hours(1);  // the clock moves only when a test says so
    options.poll = absl::Milliseconds(10);
    options.progress_interval = absl::Milliseconds(5);
    return options;
  }

  std::unique_ptr<Operations> Create(const OperationsOptions& options, const std::string& kind,
                                     OperationHandler handler) {
    auto operations = Operations::Create(options, store_.get());
    EXPECT_OK(operations);
    (*operations)->Register(kind, std::move(handler));
    EXPECT_OK((*operations)->Resume());
    return *std::move(operations);
  }

  std::string Start(Operations* operations, const std::string& kind,
                    const std::string& request = "") {
    std::string name;
    EXPECT_OK(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(const Operation operation,
                               operations->Start(transaction, {.kind = kind,
                                                               .request = request,
                                                               .subject = "templates/table",
                                                               .request_id = "r1",
                                                               .creator = "users/ada"}));
      name = operation.name;
      return absl::OkStatus();
    }));
    return name;
  }

  Operation WaitFor(Operations* operations, const std::string& name) {
    auto operation = operations->Wait(name, absl::Now() + absl::Seconds(30));
    EXPECT_OK(operation);
    return operation.ok() ? *operation : Operation{};
  }

  // The types of all events so far, progress left out.
  std::vector<std::string> EventTypes() {
    std::vector<std::string> types;
    auto numbering = store_->TakeEventNumbering();
    EXPECT_OK(numbering);
    const auto events = (*numbering)->NumberEvents(10000);
    EXPECT_OK(events);
    for (const store::NumberedEvent& event : *events) {
      EXPECT_TRUE(absl::StartsWith(event.subject, "operations/pareto/"));
      EXPECT_EQ(event.trace_id, "r1");
      if (event.type != "operation.progressed") types.push_back(event.type);
    }
    return types;
  }

  testing::TemporaryFolder folder_;
  std::string service_;
  std::atomic<int64_t> ahead_ = 0;  // microseconds the store's clock is ahead
  std::unique_ptr<store::Store> store_;
};
std::string DriverName(const ::testing::TestParamInfo<Driver>& info) {
  return info.param == Driver::kSqlite ? "Sqlite" : "Postgresql";
}
INSTANTIATE_TEST_SUITE_P(Drivers, OperationsTest,
                         ::testing::Values(Driver::kSqlite, Driver::kPostgresql), DriverName);

TEST_P(OperationsTest, RunsToItsResult) {
  auto operations = Create(Options(), "double", [](OperationContext& context) {
    EXPECT_EQ(context.checkpoint(), "");
    return absl::StatusOr<std::string>(context.request() + context.request());
  });
  const std::string name = Start(operations.get(), "double", std::string("a\0", 2));
  EXPECT_TRUE(absl::StartsWith(name, "operations/pareto/"));
  const Operation done = WaitFor(operations.get(), name);
  EXPECT_EQ(done.state, OperationState::kSucceeded);
  EXPECT_EQ(done.result, std::string("a\0a\0", 4));
  EXPECT_EQ(done.request, std::string("a\0", 2));
  EXPECT_EQ(done.subject, "templates/table");
  EXPECT_EQ(done.creator, "users/ada");
  EXPECT_TRUE(done.error.ok());
  EXPECT_THAT(EventTypes(), ElementsAre("operation.started", "operation.succeeded"));
}

TEST_P(OperationsTest, AFailureKeepsItsDetails) {
  auto operations = Create(Options(), "fail", [](OperationContext&) -> absl::StatusOr<std::string> {
    return InvalidField("height", "too high \xFF");
  });
  const Operation done = WaitFor(operations.get(), Start(operations.get(), "fail"));
  EXPECT_EQ(done.state, OperationState::kFailed);
  EXPECT_EQ(done.error.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(done.error).field, "height");
  EXPECT_THAT(EventTypes(), ElementsAre("operation.started", "operation.failed"));
}

TEST_P(OperationsTest, AnExceptionIsAFailure) {
  auto operations =
      Create(Options(), "throw", [](OperationContext&) -> absl::StatusOr<std::string> {
        throw std::runtime_error("a library's");
      });
  const Operation done = WaitFor(operations.get(), Start(operations.get(), "throw"));
  EXPECT_EQ(done.state, OperationState::kFailed);
  EXPECT_EQ(DetailOf(done.error).reason, "OPERATION_THREW");
}

TEST_P(OperationsTest, AResultTooLargeToStoreIsAFailure) {
  auto operations = Create(Options(), "huge", [](OperationContext&) -> absl::StatusOr<std::string> {
    return std::string((std::size_t{64} << 20) + 1, 'x');
  });
  const Operation done = WaitFor(operations.get(), Start(operations.get(), "huge"));
  EXPECT_EQ(done.state, OperationState::kFailed);
  EXPECT_EQ(done.error.code(), absl::StatusCode::kResourceExhausted);
}

TEST_P(OperationsTest, NothingRunsBeforeTheCommit) {
  std::atomic<int> runs = 0;
  auto operations = Create(Options(), "count", [&](OperationContext&) {
    ++runs;
    return absl::StatusOr<std::string>("");
  });
  std::string name;
  EXPECT_FALSE(store_
                   ->Transact([&](store::Transaction& transaction) -> absl::Status {
                     name = operations->Start(transaction, {.kind = "count"})->name;
                     return absl::CancelledError("changed my mind");
                   })
                   .ok());
  EXPECT_EQ(operations->Get(name).status().code(), absl::StatusCode::kNotFound);
  WaitFor(operations.get(), Start(operations.get(), "count"));
  EXPECT_EQ(runs, 1);
}

TEST_P(OperationsTest, APendingOperationIsCancelledAtOnce) {
  OperationsOptions options = Options();
  options.threads = 1;
  Gate begun;
  auto operations = Create(options, "long", [&](OperationContext& context) {
    begun.Open();
    return RunUntilStopped(context);
  });
  const std::string first = Start(operations.get(), "long");
  begun.Pass();
  const std::string second = Start(operations.get(), "long");
  const auto cancelled = operations->Cancel(second);
  ASSERT_OK(cancelled);
  EXPECT_EQ(cancelled->state, OperationState::kCancelled);
  EXPECT_EQ(WaitFor(operations.get(), second).state, OperationState::kCancelled);
  EXPECT_OK(operations->Cancel(first));
  EXPECT_EQ(WaitFor(operations.get(), first).state, OperationState::kCancelled);
  EXPECT_OK(operations->Cancel(first)) << "no effect on a finished one";
  EXPECT_THAT(EventTypes(),
              ElementsAre("operation.started", "operation.cancelled", "operation.cancelled"));
}

TEST_P(OperationsTest, WhatBelongsToAPendingOperationIsCancelledWithItOrNotAtAll) {
  OperationsOptions options = Options();
  options.threads = 1;
  Gate begun;
  auto created = Operations::Create(options, store_.get());
  ASSERT_OK(created);
  std::unique_ptr<Operations> operations = *std::move(created);
  std::atomic<bool> refuse = true;
  operations->Register(
      "long",
      [&](OperationContext& context) {
        begun.Open();
        return RunUntilStopped(context);
      },
      [&](store::Transaction& transaction, const Operation& operation) -> absl::Status {
        MORTISE_RETURN_IF_ERROR(transaction.Put("subjects", "one", operation.name).status());
        return refuse ? absl::InternalError("not now") : absl::OkStatus();
      });
  ASSERT_OK(operations->Resume());
  const std::string first = Start(operations.get(), "long");
  begun.Pass();
  const std::string second = Start(operations.get(), "long");
  const auto subject = [&] {
    std::string payload;
    EXPECT_OK(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      const auto record = transaction.Get("subjects", "one");
      if (record.ok()) payload = record->payload;
      return absl::IsNotFound(record.status()) ? absl::OkStatus() : record.status();
    }));
    return payload;
  };
  EXPECT_FALSE(operations->Cancel(second).ok());
  EXPECT_EQ(operations->Get(second)->state, OperationState::kPending);
  EXPECT_EQ(subject(), "");
  refuse = false;
  EXPECT_EQ(operations->Cancel(second)->state, OperationState::kCancelled);
  EXPECT_EQ(subject(), second);
  // Of one that runs, its handler sees to it.
  EXPECT_OK(operations->Cancel(first));
  EXPECT_EQ(WaitFor(operations.get(), first).state, OperationState::kCancelled);
  EXPECT_EQ(subject(), second);
}

TEST_P(OperationsTest, ACancelledOperationKeepsItsBestResult) {
  Gate kept;
  auto operations = Create(Options(), "improve", [&](OperationContext& context) {
    context.KeepResult("best so far");
    kept.Open();
    return RunUntilStopped(context);
  });
  const std::string name = Start(operations.get(), "improve");
  kept.Pass();
  ASSERT_OK(operations->Cancel(name));
  const Operation done = WaitFor(operations.get(), name);
  EXPECT_EQ(done.state, OperationState::kCancelled);
  EXPECT_EQ(done.result, "best so far");
}

TEST_P(OperationsTest, AWatchSeesTheLastProgressAndTheEnd) {
  Gate watched;
  auto operations = Create(Options(), "steps", [&](OperationContext& context) {
    watched.Pass();
    for (int i = 1; i <= 1000; ++i) {
      context.ReportProgress(
          {.done = i, .total = 1000, .best_so_far = 0.5 / i, .has_best = true, .message = "step"});
    }
    return absl::StatusOr<std::string>("done");
  });
  const std::string name = Start(operations.get(), "steps");
  Gate ended;  // as this watch is told; another may be told first
  std::vector<Operation> seen;
  auto watch = operations->Watch(name, [&](const Operation& operation) {
    seen.push_back(operation);  // one call at a time
    if (IsFinal(operation.state)) ended.Open();
  });
  ASSERT_OK(watch);
  watched.Open();
  ended.Pass();
  watch->reset();  // waits for a callback in progress
  ASSERT_GE(seen.size(), 2u);
  for (std::size_t i = 1; i < seen.size(); ++i) {
    EXPECT_GT(seen[i].revision, seen[i - 1].revision);
    EXPECT_GE(seen[i].progress.done, seen[i - 1].progress.done);
  }
  EXPECT_EQ(seen.back().state, OperationState::kSucceeded);
  EXPECT_EQ(seen.back().progress.done, 1000);
  EXPECT_EQ(seen.back().progress.message, "step");
  EXPECT_TRUE(seen.back().progress.has_best);
  EXPECT_DOUBLE_EQ(seen.back().progress.best_so_far, 0.5 / 1000);
}

// What a handler told last is what it began last.
TEST_P(OperationsTest, OneThatHasSucceededIsAtItsFullCount) {
  auto operations = Create(Options(), "draw", [](OperationContext& context) {
    context.ReportProgress({.done = 8, .total = 10, .message = "drawing"});
    return context.request() == "fail" ? absl::StatusOr<std::string>(InvalidField("value", "bad"))
                                       : absl::StatusOr<std::string>("done");
  });
  const auto ended = [&](const std::string& request) {
    return *operations->Wait(Start(operations.get(), "draw", request),
                             absl::Now() + absl::Seconds(60));
  };
  EXPECT_EQ(ended("draw").progress.done, 10);
  EXPECT_EQ(ended("draw").progress.total, 10);
  EXPECT_EQ(ended("fail").progress.done, 8);
}

TEST_P(OperationsTest, ShutdownLeavesItToBeResumedFromItsCheckpoint) {
  Gate saved;
  auto first = Create(Options(), "walk", [&](OperationContext& context) {
    EXPECT_OK(context.SaveCheckpoint("half way"));
    saved.Open();
    return RunUntilStopped(context);
  });
  const std::string name = Start(first.get(), "walk");
  saved.Pass();
  first.reset();
  auto second = Create(Options(), "walk", [](OperationContext& context) {
    return absl::StatusOr<std::string>("from " + context.checkpoint());
  });
  const Operation done = WaitFor(second.get(), name);
  EXPECT_EQ(done.state, OperationState::kSucceeded);
  EXPECT_EQ(done.result, "from half way");
  EXPECT_THAT(EventTypes(), ElementsAre("operation.started", "operation.succeeded"));
}

// The end of the process may fall anywhere between the start of an operation and its first step.
TEST_P(OperationsTest, ShutdownWhileWorkIsBeingLeasedLosesNothing) {
  std::vector<std::string> names;
  for (int round = 0; round < 30; ++round) {
    auto operations = Create(Options(), "walk", RunUntilStopped);
    names.push_back(Start(operations.get(), "walk"));
  }
  auto last = Create(Options(), "walk",
                     [](OperationContext&) { return absl::StatusOr<std::string>("done"); });
  for (const std::string& name : names) {
    EXPECT_EQ(WaitFor(last.get(), name).state, OperationState::kSucceeded) << name;
  }
}

// The child counts to ten, each step durable together with its checkpoint, and is killed by
// SIGKILL in the middle; after the restart no step is missing or done twice.
TEST_P(OperationsTest, SurvivesKillMinusNine) {
  const auto count_to_ten = [](OperationContext& context,
                               int kill_at) -> absl::StatusOr<std::string> {
    int step = context.checkpoint().empty() ? 0 : std::stoi(context.checkpoint());
    while (step < 10) {
      if (++step == kill_at) ::kill(::getpid(), SIGKILL);
      MORTISE_RETURN_IF_ERROR(context.TransactWithCheckpoint(
          [&](store::Transaction& transaction) {
            return transaction.Put("steps", std::to_string(step), "x", {.expected_revision = 0})
                .status();
          },
          std::to_string(step)));
    }
    return std::to_string(step);
  };
  // The parent's store must not cross the fork.
  store_.reset();
  const pid_t child = ::fork();
  if (child == 0) {
    store_ = OpenStoreAgain();
    auto operations = Create(Options(), "count",
                             [&](OperationContext& context) { return count_to_ten(context, 6); });
    WaitFor(operations.get(), Start(operations.get(), "count"));
    ::_exit(1);
  }
  int result = 0;
  ASSERT_EQ(::waitpid(child, &result, 0), child);
  ASSERT_TRUE(WIFSIGNALED(result));
  ASSERT_EQ(WTERMSIG(result), SIGKILL);

  store_ = OpenStoreAgain();
  auto operations = Create(Options(), "count", [&](OperationContext& context) {
    EXPECT_EQ(context.checkpoint(), "5");
    return count_to_ten(context, 0);
  });
  const std::vector<Operation> all = *operations->List("", 10);
  ASSERT_EQ(all.size(), 1u);
  const Operation done = WaitFor(operations.get(), all[0].name);
  EXPECT_EQ(done.state, OperationState::kSucceeded) << done.error;
  EXPECT_EQ(done.result, "10");
  EXPECT_OK(store_->Read([](store::ReadTransaction& transaction) -> absl::Status {
    EXPECT_EQ(transaction.List("steps", {})->size(), 10u);
    return absl::OkStatus();
  }));
}

TEST_P(OperationsTest, OneThatKillsItsProcessEveryTimeFails) {
  OperationsOptions options = Options();
  options.max_attempts = 2;
  store_.reset();
  for (int i = 0; i < 2; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      store_ = OpenStoreAgain();
      auto operations = Create(options, "kill", [](OperationContext&) {
        ::kill(::getpid(), SIGKILL);
        return absl::StatusOr<std::string>("");
      });
      if (i == 0) Start(operations.get(), "kill");
      Gate never;
      never.Pass();  // the kill comes first
    }
    int result = 0;
    ASSERT_EQ(::waitpid(child, &result, 0), child);
    ASSERT_TRUE(WIFSIGNALED(result) && WTERMSIG(result) == SIGKILL);
  }
  store_ = OpenStoreAgain();
  auto operations = Create(options, "kill", [](OperationContext&) {
    ADD_FAILURE() << "it has had its attempts";
    return absl::StatusOr<std::string>("");
  });
  const Operation done = WaitFor(operations.get(), operations->List("", 10)->at(0).name);
  EXPECT_EQ(done.state, OperationState::kFailed);
  EXPECT_EQ(DetailOf(done.error).reason, "OPERATION_CRASHES");
}

// Replica a stands still past its lease; b takes over; a can no longer change anything.
TEST_P(OperationsTest, ASupersededRunIsRefused) {
  Gate begun;
  Gate go_on;
  absl::Status late;  // what became of a's change
  OperationsOptions options = Options();
  options.owner = "a";
  options.threads = 1;  // so that a cannot take over from itself
  auto a = Create(options, "work", [&](OperationContext& context) {
    begun.Open();
    go_on.Pass();
    late = context.Transact([](store::Transaction& transaction) {
      return transaction.Put("effects", "late", "x").status();
    });
    return absl::StatusOr<std::string>("a");
  });
  const std::string name = Start(a.get(), "work");
  begun.Pass();
  ahead_ += absl::ToInt64Microseconds(absl::Hours(2));
  options.owner = "b";
  auto b =
      Create(options, "work", [](OperationContext&) { return absl::StatusOr<std::string>("b"); });
  EXPECT_EQ(WaitFor(b.get(), name).result, "b");
  go_on.Open();
  a.reset();
  EXPECT_FALSE(late.ok());
  EXPECT_EQ(b->Get(name)->result, "b");
  EXPECT_OK(store_->Read([](store::ReadTransaction& transaction) -> absl::Status {
    EXPECT_EQ(transaction.Get("effects", "late").status().code(), absl::StatusCode::kNotFound);
    return absl::OkStatus();
  }));
}

TEST_P(OperationsTest, AnotherReplicaWatchesAndCancels) {
  OperationsOptions options = Options();
  options.owner = "a";
  Gate begun;
  auto a = Create(options, "long", [&](OperationContext& context) {
    context.ReportProgress({.done = 7});
    begun.Open();
    return RunUntilStopped(context);
  });
  auto other_store = OpenStoreAgain();
  options.owner = "b";
  auto b = Operations::Create(options, other_store.get());
  ASSERT_OK(b);
  ASSERT_OK((*b)->Resume());
  const std::string name = Start(a.get(), "long");
  begun.Pass();
  ASSERT_OK((*b)->Cancel(name));
  const Operation done = WaitFor(b->get(), name);
  EXPECT_EQ(done.state, OperationState::kCancelled);
  EXPECT_EQ(done.progress.done, 7);
}

TEST_P(OperationsTest, ListsNewestFirstByPages) {
  auto operations = Create(Options(), "quick", [](OperationContext& context) {
    return absl::StatusOr<std::string>(context.request());
  });
  std::map<std::string, std::string> requests;
  std::vector<std::string> names;
  for (int i = 0; i < 5; ++i) {
    names.push_back(Start(operations.get(), "quick", std::to_string(i)));
    requests[names.back()] = std::to_string(i);
  }
  for (const std::string& name : names) WaitFor(operations.get(), name);
  // Names begin with their millisecond; within one the order is theirs, but it is an order.
  std::sort(names.begin(), names.end());
  const auto page = operations->List("", 2);
  ASSERT_OK(page);
  ASSERT_EQ(page->size(), 2u);
  EXPECT_EQ(page->at(0).name, names[4]);
  EXPECT_EQ(page->at(1).name, names[3]);
  EXPECT_EQ(page->at(1).result, requests[names[3]]);
  const auto rest = operations->List(page->at(1).name, 10);
  ASSERT_EQ(rest->size(), 3u);
  EXPECT_EQ(rest->at(2).name, names[0]);
}

TEST_P(OperationsTest, VisitsOneByOneWhatPassesTheFilter) {
  auto operations = Create(Options(), "quick", [](OperationContext& context) {
    if (context.request() == "fail") return absl::StatusOr<std::string>(absl::InternalError("x"));
    return absl::StatusOr<std::string>(context.request());
  });
  std::vector<std::string> names;
  for (int i = 0; i < 150; ++i) {
    names.push_back(Start(operations.get(), "quick", i % 3 == 0 ? "fail" : "done"));
  }
  for (const std::string& name : names) WaitFor(operations.get(), name);
  std::sort(names.begin(), names.end(), std::greater<>());
  const auto visited = [&](const OperationFilter& filter, std::size_t most,
                           const std::string& after = "") {
    std::vector<std::string> seen;
    EXPECT_OK(operations->Visit(after, filter, [&] {
      return [&](const Operation& operation) {
        seen.push_back(operation.name);
        return seen.size() < most;
      };
    }));
    return seen;
  };
  EXPECT_EQ(visited({}, 1000), names);
  EXPECT_EQ(visited({}, 2, names[99]), (std::vector<std::string>{names[100], names[101]}));
  EXPECT_EQ(visited({.states = {OperationState::kFailed}}, 1000).size(), 50u);
  EXPECT_EQ(visited({.states = {OperationState::kFailed, OperationState::kSucceeded}}, 1000),
            names);
  EXPECT_TRUE(visited({.kind = "other"}, 1000).empty());
  EXPECT_TRUE(visited({.subject = "other"}, 1000).empty());
}

// The database goes while one is shown the first of many, and comes back at once.
TEST_P(OperationsTest, AVisitBeginsAnewWhereTheDatabaseWasLost) {
  auto operations = Create(Options(), "quick", [](OperationContext& context) {
    return absl::StatusOr<std::string>(context.request());
  });
  std::vector<std::string> names;
  for (int i = 0; i < 120; ++i) names.push_back(Start(operations.get(), "quick"));
  for (const std::string& name : names) WaitFor(operations.get(), name);
  std::sort(names.begin(), names.end(), std::greater<>());
  std::vector<std::string> seen;
  int visitors = 0;
  EXPECT_OK(operations->Visit("", {}, [&] {
    ++visitors;
    seen.clear();
    return [&](const Operation& operation) {
      if (visitors == 1 && seen.empty()) LoseDatabase();
      seen.push_back(operation.name);
      return true;
    };
  }));
  EXPECT_EQ(seen, names) << "each of them once";
  EXPECT_EQ(visitors, GetParam() == Driver::kPostgresql ? 2 : 1);
}

TEST_P(OperationsTest, BadInputNamesTheField) {
  auto operations = Create(Options(), "known", RunUntilStopped);
  const auto field = [](const absl::Status& status) {
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  EXPECT_EQ(field(store_->Transact([&](store::Transaction& transaction) {
              return operations->Start(transaction, {.kind = "unknown"}).status();
            })),
            "kind");
  EXPECT_EQ(field(operations->Get("operations/catalog/x").status()), "name");
  EXPECT_EQ(field(operations->Get("operations/pareto/").status()), "name");
  EXPECT_EQ(field(operations->Cancel("x").status()), "name");
  EXPECT_EQ(field(operations->List("nonsense", 10).status()), "name");
  EXPECT_EQ(field(operations->List("", 0).status()), "limit");
  EXPECT_EQ(operations->Get("operations/pareto/none").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(operations->Wait("operations/pareto/none", absl::Now()).status().code(),
            absl::StatusCode::kNotFound);
  OperationsOptions options = Options();
  options.threads = 0;
  EXPECT_EQ(field(Operations::Create(options, store_.get()).status()), "threads");
}

TEST_P(OperationsTest, WaitReturnsAtItsDeadline) {
  auto operations = Create(Options(), "long", RunUntilStopped);
  const std::string name = Start(operations.get(), "long");
  const auto operation = operations->Wait(name, absl::Now() + absl::Milliseconds(20));
  ASSERT_OK(operation);
  EXPECT_FALSE(IsFinal(operation->state));
  ASSERT_OK(operations->Wait(name, absl::InfinitePast()));
}

}  // namespace
}  // namespace mortise::jobs
