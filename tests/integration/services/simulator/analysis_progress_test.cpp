// How far an analysis is, as those who watch its operation see it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "tests/integration/services/simulator/mesh_service.h"

namespace mortise::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class AnalysisProgressTest : public MeshServiceTest {
 protected:
  v1::Operation StartBar() {
    v1::Operation operation;
    const auto status =
        Start(WithManyCases(Upload(testing::WriteGmsh41(box_, true)), "watched"), operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  // A task for a worker that this test plays.
  v1::TaskAttempt Lease(double seconds) {
    v1::LeaseTasksRequest request;
    request.set_evaluator("simulator");
    request.set_worker("played");
    request.set_limit(1);
    request.set_lease_seconds(seconds);
    request.set_wait_seconds(60);
    v1::LeaseTasksResponse response;
    const auto context = Context();
    EXPECT_TRUE(Simulator()->LeaseTasks(context.get(), request, &response).ok());
    v1::TaskAttempt attempt;
    EXPECT_EQ(response.tasks_size(), 1);
    if (response.tasks().empty()) return attempt;
    attempt.set_name(response.tasks(0).name());
    attempt.set_attempt(response.tasks(0).attempt());
    return attempt;
  }

  absl::StatusOr<v1::RenewLeasesResponse> Renew(v1::TaskAttempt attempt, int done, int total,
                                                const std::string& stage, double lease = 60) {
    attempt.mutable_progress()->set_done(done);
    attempt.mutable_progress()->set_total(total);
    attempt.mutable_progress()->set_stage(stage);
    v1::RenewLeasesRequest request;
    request.set_worker("played");
    request.set_lease_seconds(lease);
    *request.add_tasks() = attempt;
    v1::RenewLeasesResponse response;
    const auto context = Context();
    const grpc::Status status = Simulator()->RenewLeases(context.get(), request, &response);
    if (!status.ok()) return rpc::FromGrpc(status);
    return response;
  }

  // Watches an operation until `enough` of it has been seen, or it is done; gives all that was.
  std::vector<v1::Progress> Watch(const v1::Operation& operation,
                                  const std::function<bool(const v1::Progress&)>& enough) {
    const auto stub = v1::OperationService::NewStub(service_.channel());
    v1::WatchOperationRequest request;
    request.set_name(operation.name());
    const auto context = Context();
    const auto reader = stub->WatchOperation(context.get(), request);
    std::vector<v1::Progress> seen;
    v1::Operation now;
    bool found = false;
    while (!found && reader->Read(&now)) {
      seen.push_back(now.progress());
      found = enough(now.progress());
    }
    EXPECT_TRUE(found) << now.ShortDebugString();
    context->TryCancel();
    while (reader->Read(&now)) {
    }
    reader->Finish();
    return seen;
  }
};

TEST_F(AnalysisProgressTest, AWorkerTellsItsStages) {
  const v1::Operation operation = StartBar();
  Watch(operation, [](const v1::Progress& now) { return now.message() == "waiting for a worker"; });
  const auto worker = StartWorker("only");
  const std::vector<v1::Progress> seen =
      Watch(operation, [](const v1::Progress& now) { return now.done() > 3; });
  EXPECT_THAT(seen.back().message(), HasSubstr("load case "));
  EXPECT_THAT(seen.back().message(), HasSubstr(" of 50"));
  EXPECT_EQ(seen.back().total(), 152);  // mesh, stiffness, three of each load case
  for (std::size_t i = 1; i < seen.size(); ++i) EXPECT_GE(seen[i].done(), seen[i - 1].done());
  Cancel(operation.name());
}

TEST_F(AnalysisProgressTest, NeverGoesBackWithinAnAttemptAndIsLostWithIt) {
  const v1::Operation operation = StartBar();
  const v1::TaskAttempt first = Lease(60);
  Watch(operation, [](const v1::Progress& now) { return now.message() == "with a worker"; });
  ASSERT_TRUE(Renew(first, 3, 7, "stiffness").ok());
  Watch(operation, [](const v1::Progress& now) {
    return now.done() == 3 && now.total() == 7 && now.message() == "stiffness";
  });
  ASSERT_TRUE(Renew(first, 2, 7, "mesh").ok());
  ASSERT_TRUE(Renew(first, 4, 7, "load case 1 of 1").ok());
  for (const v1::Progress& now :
       Watch(operation, [](const v1::Progress& told) { return told.done() == 4; })) {
    EXPECT_NE(now.message(), "mesh");
  }
  // The worker vanishes; its lease runs out after a second.
  ASSERT_TRUE(Renew(first, 4, 7, "load case 1 of 1", 1).ok());
  Watch(operation, [](const v1::Progress& now) {
    return now.done() == 0 && now.message() == "waiting for a worker";
  });
  const v1::TaskAttempt second = Lease(60);
  EXPECT_EQ(second.name(), first.name());
  EXPECT_EQ(second.attempt(), 2);
  ASSERT_TRUE(Renew(second, 1, 7, "mesh").ok());
  Watch(operation, [](const v1::Progress& now) { return now.done() == 1; });
  const auto late = Renew(first, 6, 7, "files");
  ASSERT_TRUE(late.ok()) << late.status();
  EXPECT_THAT(late->lost(), ElementsAre(first.name()));
  v1::ReportTaskRequest report;
  *report.mutable_task() = second;
  const auto context = Context();
  v1::ReportTaskResponse reported;
  ASSERT_TRUE(Simulator()->ReportTask(context.get(), report, &reported).ok());
  const v1::Operation done = Wait(operation.name());
  EXPECT_EQ(done.state(), v1::Operation::SUCCEEDED);
  EXPECT_EQ(done.progress().done(), 7);
  EXPECT_EQ(done.progress().total(), 7);
}

TEST_F(AnalysisProgressTest, NumbersThatMeanNothingAreRefused) {
  StartBar();
  const v1::TaskAttempt attempt = Lease(60);
  const auto field = [&](int done, int total, const std::string& stage) {
    const absl::Status refused = Renew(attempt, done, total, stage).status();
    EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
    return DetailOf(refused).field;
  };
  EXPECT_EQ(field(8, 7, "mesh"), "tasks[0].progress.done");
  EXPECT_EQ(field(-1, 7, "mesh"), "tasks[0].progress.done");
  EXPECT_EQ(field(0, 0, "mesh"), "tasks[0].progress.total");
  EXPECT_EQ(field(0, 2000000, "mesh"), "tasks[0].progress.total");
  EXPECT_EQ(field(0, 7, std::string(201, 'x')), "tasks[0].progress.stage");
  const auto renewed = Renew(attempt, 7, 7, "");
  ASSERT_TRUE(renewed.ok()) << renewed.status();
  EXPECT_THAT(renewed->lost(), IsEmpty());
}

}  // namespace
}  // namespace mortise::simulator
