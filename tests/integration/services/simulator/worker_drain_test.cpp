// What a worker that is asked to end does with the task at hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/integration/services/simulator/mesh_service.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class WorkerDrainTest : public MeshServiceTest {
 protected:
  // A worker whose lease does not run out while a test looks on.
  std::unique_ptr<testing::ChildProcess> StartWorker(const std::string& drain_seconds) const {
    return std::make_unique<testing::ChildProcess>(std::vector<std::string>{
        testing::BuiltProgram("mortise-simulator"), "--worker", "--insecure-development",
        "--lease-seconds=60", "--peer=simulator=" + service_.address(),
        "--peer=catalog=" + catalog_.address(), "--drain-seconds=" + drain_seconds});
  }

  // Starts work of some `cases`, half a second each, and a worker, and waits until that is at it.
  std::unique_ptr<testing::ChildProcess> StartWorking(int cases, const std::string& drain_seconds) {
    v1::AnalyzeMeshRequest work =
        WithManyCases(Upload(testing::WriteGmsh41(box_, true)), "drained");
    auto& load_cases = *work.mutable_case_()->mutable_load_cases();
    load_cases.DeleteSubrange(cases, load_cases.size() - cases);
    EXPECT_TRUE(Start(work, operation_).ok());
    auto worker = StartWorker(drain_seconds);
    EXPECT_TRUE(WaitUntilLeased());
    return worker;
  }

  // Takes the task as a worker that this test plays; waits for it.
  v1::Task Lease() {
    v1::LeaseTasksRequest request;
    request.set_worker("played");
    request.set_limit(1);
    request.set_lease_seconds(60);
    request.set_wait_seconds(60);
    v1::LeaseTasksResponse response;
    const auto context = Context();
    EXPECT_TRUE(Simulator()->LeaseTasks(context.get(), request, &response).ok());
    EXPECT_EQ(response.tasks_size(), 1);
    return response.tasks().empty() ? v1::Task() : response.tasks(0);
  }

  // Asks for the masses of many tables: moments of work each.
  void WeighTables() {
    constexpr int kTables = 300;
    v1::EvaluateBatchRequest request;
    request.set_subject("templates/table");
    request.add_metrics("mass");
    for (int i = 0; i < kTables; ++i) {
      v1::DesignPoint& point = *request.add_points();
      for (const v1::Parameter& parameter : catalog_.table().parameters()) {
        const double share = 0.3 + 0.4 * i / kTables;
        point.add_parameters(parameter.minimum() +
                             share * (parameter.maximum() - parameter.minimum()));
      }
    }
    const auto context = Context();
    const auto evaluators = v1::EvaluatorService::NewStub(service_.channel());
    const auto reader = evaluators->EvaluateBatch(context.get(), request);
    v1::EvaluationResult result;
    while (reader->Read(&result)) EXPECT_FALSE(result.has_error()) << result.error().message();
    EXPECT_TRUE(reader->Finish().ok());
  }

  v1::QueueStatus Status() const {
    v1::QueueStatus status;
    const auto context = Context();
    EXPECT_TRUE(Simulator()->GetQueueStatus(context.get(), {}, &status).ok());
    return status;
  }

  // The analyses that workers hold.
  int LeasedAnalyses() const {
    v1::ListTasksRequest request;
    request.set_state(v1::LEASED);
    v1::ListTasksResponse response;
    const auto context = Context();
    EXPECT_TRUE(Simulator()->ListTasks(context.get(), request, &response).ok());
    int analyses = 0;
    for (const auto& entry : response.tasks()) analyses += entry.task().has_case_() ? 1 : 0;
    return analyses;
  }

  v1::Operation operation_;
};

// Short tasks are leased several at a time, and analyses that come then with them. Behind one that
// takes long nothing must wait: whoever asks gets it.
TEST_F(WorkerDrainTest, DoesNotSitOnWhatItLeasedAhead) {
  std::thread client([&] { WeighTables(); });
  const auto worker = StartWorker("0");
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  const auto wait_until = [&](const auto& condition) {
    while (!condition() && std::chrono::steady_clock::now() < end) {
    }
    return condition();
  };
  EXPECT_TRUE(wait_until([&] { return Status().done() >= 50; }));
  std::vector<std::string> operations;
  for (const char* name : {"first", "second"}) {
    v1::AnalyzeMeshRequest work = WithManyCases(Upload(testing::WriteGmsh41(box_, true)), name);
    work.mutable_case_()->set_title(name);
    EXPECT_TRUE(Start(work, operation_).ok());
    operations.push_back(operation_.name());
  }
  EXPECT_TRUE(wait_until([&] { return Status().leased() == 1 && LeasedAnalyses() == 1; }));
  for (const std::string& operation : operations) Cancel(operation);
  client.join();
  EXPECT_EQ(worker->End(SIGTERM), 0);
}

TEST_F(WorkerDrainTest, GivesBackWhatTakesLongerThanItHas) {
  const auto worker = StartWorking(50, "0");
  worker->Signal(SIGTERM);
  worker->Signal(SIGTERM);  // as schedulers do that ask both a process and its parent
  EXPECT_EQ(worker->Wait(), 0);
  EXPECT_THAT(worker->Output(), HasSubstr("task given back"));
  EXPECT_EQ(Lease().attempt(), 2);
  Cancel(operation_.name());
}

TEST_F(WorkerDrainTest, GivenBackIsNotHeldAgainstATask) {
  // Three workers that died of it would put the task aside; six that were asked to end do not.
  auto worker = StartWorking(50, "0");
  for (int life = 0; life < 6; ++life) {
    EXPECT_EQ(worker->End(SIGTERM), 0);
    worker = StartWorker("0");
    ASSERT_TRUE(WaitUntilLeased());
  }
  EXPECT_EQ(worker->End(SIGTERM), 0);
  EXPECT_EQ(Lease().attempt(), 8);
  Cancel(operation_.name());
}

TEST_F(WorkerDrainTest, FinishesWhatItHasTheTimeFor) {
  const auto worker = StartWorking(8, "3600");
  worker->Signal(SIGTERM);
  EXPECT_EQ(ResultOf(Wait(operation_.name())).cases_size(), 8);
  EXPECT_EQ(worker->Wait(), 0);
  EXPECT_THAT(worker->Output(), HasSubstr("task reported"));
  EXPECT_THAT(worker->Output(), Not(HasSubstr("task given back")));
}

TEST(WorkerAccessTest, OneWayOfBeingKnownIsNeeded) {
  const auto refusal = [](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {testing::BuiltProgram("mortise-simulator"), "--worker"});
    testing::ChildProcess worker(flags);
    EXPECT_EQ(worker.Wait(), 1);
    return worker.Output();
  };
  EXPECT_THAT(refusal({"--gateway=127.0.0.1:1"}), HasSubstr("--token-file"));
  EXPECT_THAT(refusal({"--gateway=127.0.0.1:1", "--token-file=t", "--insecure-development"}),
              HasSubstr("give one of --keys, --token-file"));
  EXPECT_THAT(refusal({"--gateway=127.0.0.1:1", "--token-file=t", "--peer=simulator=127.0.0.1:2"}),
              HasSubstr("services take no tokens"));
  EXPECT_THAT(refusal({"--token-file=t"}), HasSubstr("--gateway"));
  EXPECT_THAT(refusal({"--gateway=127.0.0.1:1", "--token-file=t"}), HasSubstr("TLS only"));
}

}  // namespace
}  // namespace mortise::simulator
