// Operations on both store drivers: life cycle, cancelling, progress.
#include "common/operations/operations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/operations/operations_fixture.h"

namespace mortise::operations {
namespace {

using ::testing::ElementsAre;

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
}  // namespace mortise::operations
