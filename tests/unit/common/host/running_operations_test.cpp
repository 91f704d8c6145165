// The operations of a whole service over gRPC: run, watched, cancelled and listed.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/rpc/channel.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/host/running_service_fixture.h"
#include "tests/unit/common/rpc/probe_service.h"

namespace mortise::testing {
namespace {

using rpc::CallUnary;

TEST_F(RunningServiceTest, AnOperationRunsToItsResult) {
  const v1::Operation begun = Begin("r-1", "x");
  EXPECT_EQ(begun.subject(), "things/a");
  EXPECT_EQ(begun.creator(), "users/ada");
  EXPECT_EQ(Begin("r-1", "x").name(), begun.name()) << "one request, one operation";
  Release();
  const auto done = Wait(begun.name());
  ASSERT_OK(done);
  EXPECT_EQ(done->state(), v1::Operation::SUCCEEDED);
  EXPECT_EQ(done->progress().total(), 2);
  Kept kept;
  ASSERT_TRUE(done->result().UnpackTo(&kept));
  EXPECT_EQ(kept.value(), "x");
}

TEST_F(RunningServiceTest, AFailureKeepsItsDetails) {
  const auto failed = Wait(Begin("r-1", "fail").name());
  ASSERT_OK(failed);
  EXPECT_EQ(failed->state(), v1::Operation::FAILED);
  EXPECT_EQ(failed->error().code(), 3);
  EXPECT_EQ(failed->error().details_size(), 2);
}

TEST_F(RunningServiceTest, AWaitEndsInTime) {
  const std::string name = Begin("r-1", "x").name();
  const auto waited = Wait(name, 0.05);
  ASSERT_OK(waited);
  EXPECT_NE(waited->state(), v1::Operation::SUCCEEDED);
  // A wait of 0 is one, and not the default of a minute.
  const auto now = Wait(name, 0);
  ASSERT_OK(now);
  EXPECT_NE(now->state(), v1::Operation::SUCCEEDED);
  EXPECT_EQ(DetailOf(Wait(name, -1).status()).field, "timeout_seconds");
  EXPECT_TRUE(absl::IsNotFound(Wait("operations/probe/none").status()));
}

TEST_F(RunningServiceTest, AnOperationIsCancelled) {
  const std::string name = Begin("r-1", "x").name();
  ASSERT_OK(Cancel("c-1", name));
  ASSERT_OK(Cancel("c-1", name));
  const auto done = Wait(name);
  ASSERT_OK(done);
  EXPECT_EQ(done->state(), v1::Operation::CANCELLED);
}

// Beginning takes an operator: so does stopping what was begun.
TEST_F(RunningServiceTest, CancellingTakesTheRoleOfWhatStartedIt) {
  const v1::Operation begun = Begin("r-1", "x");
  EXPECT_EQ(begun.method(), "mortise.testing.ProbeService/Begin");
  const absl::Status refused = Cancel("c-1", begun.name(), rpc::Role::kDesigner).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kPermissionDenied) << refused;
  EXPECT_EQ(DetailOf(refused).reason, "ROLE_REQUIRED");
  EXPECT_EQ(DetailOf(refused).field, begun.method());
  const auto running = Wait(begun.name(), 0.05);
  ASSERT_OK(running);
  EXPECT_FALSE(running->cancel_requested());
  EXPECT_NE(running->state(), v1::Operation::CANCELLED);
  const auto stopping = Cancel("c-2", begun.name(), rpc::Role::kOperator);
  ASSERT_OK(stopping);
  EXPECT_TRUE(stopping->cancel_requested());
  EXPECT_EQ(Wait(begun.name())->state(), v1::Operation::CANCELLED);
}

// Which role the method of an earlier version needed is not known: the most that any did.
TEST_F(RunningServiceTest, CancellingWhatAnEarlierVersionStartedTakesAnOperator) {
  keeps_methods_ = false;
  const v1::Operation begun = Begin("r-1", "x");
  EXPECT_EQ(begun.method(), "");
  EXPECT_EQ(Cancel("c-1", begun.name(), rpc::Role::kDesigner).status().code(),
            absl::StatusCode::kPermissionDenied);
  EXPECT_OK(Cancel("c-2", begun.name(), rpc::Role::kOperator));
}

TEST_F(RunningServiceTest, AWatchSeesTheEnd) {
  const std::string name = Begin("r-1", "x").name();
  v1::WatchOperationRequest request;
  request.set_name(name);
  auto context = rpc::MakeClientContext(As(rpc::Role::kViewer));
  auto reader = operations_->WatchOperation(context.get(), request);
  v1::Operation seen;
  ASSERT_TRUE(reader->Read(&seen));
  EXPECT_EQ(seen.name(), name);
  Release();
  while (reader->Read(&seen)) {
  }
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_EQ(seen.state(), v1::Operation::SUCCEEDED);
}

TEST_F(RunningServiceTest, ListsOperationsNewestFirst) {
  Release();
  std::vector<std::string> names;
  for (int i = 0; i < 5; ++i) names.push_back(Begin("r-" + std::to_string(i), "x").name());
  v1::ListOperationsRequest request;
  request.set_page_size(3);
  std::vector<std::string> listed;
  do {
    const auto page = CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                                As(rpc::Role::kViewer));
    ASSERT_OK(page);
    for (const v1::Operation& operation : page->operations()) listed.push_back(operation.name());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(listed, std::vector<std::string>(names.rbegin(), names.rend()));
  request.set_page_size(1001);
  EXPECT_EQ(DetailOf(CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                               As(rpc::Role::kViewer))
                         .status())
                .field,
            "page_size");
  request.set_page_size(3);
  // A token of the list of all services is none of the list of one.
  const auto whole = CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                               As(rpc::Role::kViewer));
  ASSERT_OK(whole);
  ASSERT_FALSE(whole->next_page_token().empty());
  request.set_page_token(whole->next_page_token());
  request.set_service("probe");
  EXPECT_EQ(DetailOf(CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                               As(rpc::Role::kViewer))
                         .status())
                .field,
            "page_token");
  request.set_page_token("no such token");
  EXPECT_EQ(DetailOf(CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                               As(rpc::Role::kViewer))
                         .status())
                .field,
            "page_token");
}

// gRPC's clients take 4 MiB: a page of large operations is shorter than was asked for.
TEST_F(RunningServiceTest, APageOfLargeOperationsFitsIntoAMessage) {
  constexpr int kOperations = 12;
  Release();
  std::vector<std::string> names;
  for (int i = 0; i < kOperations; ++i) {
    names.push_back(Begin("r-" + std::to_string(i), std::string(900'000, 'x')).name());
    ASSERT_OK(Wait(names.back()));
  }
  v1::ListOperationsRequest request;
  std::vector<std::string> listed;
  int pages = 0;
  do {
    const auto page = List(request);
    ASSERT_OK(page);
    EXPECT_LT(page->ByteSizeLong(), std::size_t{4} << 20);
    for (const v1::Operation& operation : page->operations()) {
      listed.push_back(operation.name());
      EXPECT_TRUE(operation.has_result());
    }
    request.set_page_token(page->next_page_token());
    ASSERT_LE(++pages, kOperations);
  } while (!request.page_token().empty());
  EXPECT_EQ(listed, std::vector<std::string>(names.rbegin(), names.rend()));
  EXPECT_GT(pages, 1);
  request.set_omit_results(true);
  const auto without = List(request);
  ASSERT_OK(without);
  EXPECT_EQ(without->operations_size(), kOperations);
  EXPECT_FALSE(without->operations(0).has_result());
}

TEST_F(RunningServiceTest, ListsOnlyWhatPassesTheFilters) {
  const std::string running = Begin("r-1", "x").name();
  const std::string failed = Begin("r-2", "fail").name();
  ASSERT_OK(Wait(failed));
  const auto names = [&](const v1::ListOperationsRequest& request) {
    std::vector<std::string> found;
    const auto page = List(request);
    EXPECT_OK(page);
    for (const v1::Operation& operation : page->operations()) found.push_back(operation.name());
    return found;
  };
  v1::ListOperationsRequest request;
  request.add_states(v1::Operation::FAILED);
  EXPECT_EQ(names(request), std::vector<std::string>{failed});
  request.set_states(0, v1::Operation::PENDING);
  request.add_states(v1::Operation::RUNNING);
  EXPECT_EQ(names(request), std::vector<std::string>{running});
  request.set_kind("pareto.discovery");
  EXPECT_TRUE(names(request).empty());
  request.Clear();
  request.set_subject("things/a");
  EXPECT_EQ(names(request), (std::vector<std::string>{failed, running}));
  request.set_subject("things/b");
  EXPECT_TRUE(names(request).empty());
  request.add_states(v1::Operation::STATE_UNSPECIFIED);
  EXPECT_EQ(DetailOf(List(request).status()).field, "states[0]");
}

TEST_F(RunningServiceTest, ListsOperationsByWhatTheirRequestsAttached) {
  Release();
  const auto begin = [&](const std::string& id, const std::string& external_id,
                         const std::string& project) {
    KeepRequest request;
    request.set_request_id(id);
    request.set_name("a");
    request.add_external_ids(external_id);
    (*request.mutable_labels())["project"] = project;
    const auto begun =
        CallUnary(*probe_, &ProbeService::Stub::Begin, request, As(rpc::Role::kOperator));
    EXPECT_OK(begun);
    return begun.ok() ? *begun : v1::Operation();
  };
  const v1::Operation first = begin("r-1", "100-4711/A", "loft");
  const v1::Operation second = begin("r-2", "100-4711/B", "loft");
  const v1::Operation third = begin("r-3", "100-4711/A", "shed");
  EXPECT_EQ(first.external_ids(0), "100-4711/A");
  EXPECT_EQ(Wait(third.name())->labels().at("project"), "shed");
  const auto names = [&](v1::ListOperationsRequest request) {
    std::vector<std::string> found;
    request.set_page_size(1);
    do {
      const auto page = List(request);
      EXPECT_OK(page);
      if (!page.ok()) break;
      for (const v1::Operation& operation : page->operations()) found.push_back(operation.name());
      request.set_page_token(page->next_page_token());
    } while (!request.page_token().empty());
    return found;
  };
  v1::ListOperationsRequest request;
  request.mutable_filter()->set_external_id("100-4711/A");
  EXPECT_EQ(names(request), (std::vector<std::string>{third.name(), first.name()}));
  (*request.mutable_filter()->mutable_labels())["project"] = "loft";
  EXPECT_EQ(names(request), std::vector<std::string>{first.name()});
  request.mutable_filter()->Clear();
  (*request.mutable_filter()->mutable_labels())["project"] = "";
  EXPECT_EQ(names(request).size(), 3u);
  request.mutable_filter()->set_creator("users/ben");
  EXPECT_TRUE(names(request).empty());
  request.mutable_filter()->Clear();
  *request.mutable_filter()->mutable_created_from() = second.create_time();
  EXPECT_EQ(names(request), (std::vector<std::string>{third.name(), second.name()}));
}

TEST_F(RunningServiceTest, TellsAllThatIsWrongWithAListOfOperations) {
  v1::ListOperationsRequest request;
  request.set_page_size(-1);
  request.set_kind("zzz");
  (*request.mutable_filter()->mutable_labels())["-"] = "x";
  std::vector<std::string> fields;
  for (const FieldViolation& violation : AllViolationsOf(List(request).status())) {
    fields.push_back(violation.field);
  }
  EXPECT_EQ(fields, (std::vector<std::string>{"page_size", "kind", "filter.labels"}));
}

TEST_F(RunningServiceTest, FiltersThatMeanNothingAreRefusedByName) {
  v1::ListOperationsRequest request;
  request.set_kind("zzz");
  EXPECT_EQ(List(request).status().message(),
            "kind: 'zzz' is none of fabplanner.plan, fabplanner.workOrder, interpolator.map, "
            "interpolator.verification, pareto.discovery, retrieval.index, simulator.analysis");
  request.set_kind("");
  request.set_subject("nope");
  EXPECT_EQ(List(request).status().message(),
            "subject: 'nope' is no resource name, such as fronts/a1");
}

}  // namespace
}  // namespace mortise::testing
