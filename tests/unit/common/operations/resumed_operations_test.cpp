// Operations that go on after their process has ended, and where another takes over.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/operations/operations_fixture.h"

namespace mortise::operations {
namespace {

using ::testing::ElementsAre;

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

}  // namespace
}  // namespace mortise::operations
