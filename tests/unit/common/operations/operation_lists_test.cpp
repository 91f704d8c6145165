// Operations that are listed and visited.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "tests/support/status_assertions.h"
#include "tests/unit/common/operations/operations_fixture.h"

namespace mortise::operations {
namespace {

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

TEST_P(OperationsTest, KeepsTheTagsOfWhatStartedIt) {
  const OperationTags tags{.external_ids = {"100-4711/A", "ä"},
                           .labels = {{"project", "loft"}, {"urgent", ""}}};
  OperationTags seen;
  std::string creator;
  auto operations = Create(Options(), "quick", [&](OperationContext& context) {
    seen = context.operation().tags;
    creator = context.operation().creator;
    context.ReportProgress({.done = 1, .total = 2});
    return absl::StatusOr<std::string>("result");
  });
  std::string name;
  ASSERT_OK(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(
        const Operation started,
        operations->Start(
            transaction,
            {.kind = "quick", .trace_id = "r1", .creator = "users/ada", .tags = tags}));
    EXPECT_EQ(started.tags.labels, tags.labels);
    name = started.name;
    return absl::OkStatus();
  }));
  const Operation done = WaitFor(operations.get(), name);
  EXPECT_EQ(done.tags.external_ids, tags.external_ids);
  EXPECT_EQ(done.tags.labels, tags.labels);
  EXPECT_EQ(seen.external_ids, tags.external_ids) << "its handler reads them";
  EXPECT_EQ(seen.labels, tags.labels);
  EXPECT_EQ(creator, "users/ada");
}

// What an earlier version wrote: neither the method nor tags.
TEST_P(OperationsTest, ReadsRecordsWithoutTags) {
  auto operations = Create(Options(), "quick", [](OperationContext& context) {
    return absl::StatusOr<std::string>(context.request());
  });
  ASSERT_OK(store_->Transact([](store::Transaction& transaction) {
    return transaction
        .Put("operations", "0198c1x",
             R"({"kind": "quick", "subject": "templates/table", "request_id": "r1",
                 "creator": "users/ada", "state": 2, "cancel_requested": false,
                 "progress": {"done": 3, "total": 3, "message": "done"},
                 "error": {"code": 0, "message": "", "reason": "", "field": ""}})")
        .status();
  }));
  const auto operation = operations->Get("operations/pareto/0198c1x");
  ASSERT_OK(operation);
  EXPECT_EQ(operation->state, OperationState::kSucceeded);
  EXPECT_EQ(operation->creator, "users/ada");
  EXPECT_TRUE(operation->tags.external_ids.empty());
  EXPECT_TRUE(operation->tags.labels.empty());
}

TEST_P(OperationsTest, AsksAFilterOfItsOwnBeforeItReadsResults) {
  auto operations = Create(Options(), "quick", [](OperationContext& context) {
    return absl::StatusOr<std::string>(context.request());
  });
  const std::string wanted = Start(operations.get(), "quick", "wanted");
  const std::string other = Start(operations.get(), "quick", "other");
  WaitFor(operations.get(), wanted);
  WaitFor(operations.get(), other);
  std::vector<std::string> results;
  const OperationFilter filter{.subject = "templates/table",
                               .takes = [&](const Operation& operation) {
                                 EXPECT_TRUE(operation.result.empty()) << "not read for this";
                                 return operation.name == wanted;
                               }};
  EXPECT_OK(operations->Visit("", filter, [&] {
    return [&](const Operation& operation) {
      results.push_back(operation.result);
      return true;
    };
  }));
  EXPECT_EQ(results, std::vector<std::string>{"wanted"});
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

}  // namespace
}  // namespace mortise::operations
