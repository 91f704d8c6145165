// A thousand tasks while workers are killed every few tasks and the service twice: every one is
// done, and what was accepted once stays.
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <map>
#include <memory>
#include <thread>
#include <vector>

#include "common/rpc/status_mapping.h"
#include "google/rpc/status.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/service_under_test.h"
#include "tests/support/private_postgresql.h"

namespace mortise::simulator {
namespace {

constexpr int kTasks = 1000;
constexpr int kWorkers = 4;

// Workers that are replaced as they die.
class Workers {
 public:
  explicit Workers(const std::string& address) {
    for (int slot = 0; slot < kWorkers; ++slot) {
      threads_.emplace_back([this, address, slot] { Keep(address, slot); });
    }
  }
  ~Workers() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

  int deaths() const { return deaths_; }

 private:
  void Keep(const std::string& address, int slot) {
    for (int life = 0; !stop_; ++life) {
      testing::ChildProcess worker({testing::BuiltProgram("synthetic-worker"), address,
                                    "--lease-seconds=6", "--death-rate=0.12",
                                    "--seed=" + std::to_string(kWorkers * life + slot)});
      while (!stop_ && !HasEnded(worker)) {
      }
      if (stop_) return;
      ++deaths_;
    }
  }

  static bool HasEnded(const testing::ChildProcess& worker) {
    pollfd end{.fd = worker.end_descriptor(), .events = POLLIN, .revents = 0};
    return ::poll(&end, 1, 100) > 0;
  }

  std::atomic<bool> stop_ = false;
  std::atomic<int> deaths_ = 0;
  std::vector<std::thread> threads_;
};

using Results = std::map<int, v1::EvaluationResult>;

class WorkerFaultsTest : public ::testing::Test {
 protected:
  static v1::EvaluateBatchRequest Batch() {
    v1::EvaluateBatchRequest request;
    request.set_subject("evaluators/synthetic");
    request.add_metrics("square");
    request.add_metrics("mark");
    for (int i = 0; i < kTasks; ++i) request.add_points()->add_parameters(i);
    return request;
  }

  static void Register(testing::ServiceUnderTest& service) {
    v1::CreateEvaluatorRequest create;
    ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(
        "request_id: 'create' evaluator { name: 'evaluators/synthetic' space {"
        " parameters { name: 'x' maximum: 1000 } metrics { name: 'square' }"
        " metrics { name: 'mark' } } }",
        &create));
    const auto stub = v1::EvaluatorService::NewStub(service.channel());
    ASSERT_TRUE(testing::Call(*stub, &v1::EvaluatorService::Stub::CreateEvaluator, create).ok());
  }

  // Adds what a batch gives to `results`, and kills and starts the service when there are so many.
  // Whether the batch came to its end.
  static bool Ask(testing::ServiceUnderTest& service, int kill_at, Results& results) {
    const auto stub = v1::EvaluatorService::NewStub(service.channel());
    grpc::ClientContext context;
    testing::Prepare(context);
    const auto reader = stub->EvaluateBatch(&context, Batch());
    v1::EvaluationResult result;
    int seen = 0;
    while (reader->Read(&result)) {
      EXPECT_FALSE(result.has_error()) << result.error().message();
      result.clear_cached();
      const auto [place, is_new] = results.emplace(result.index(), result);
      // A result that was given once is never replaced by that of another attempt.
      if (!is_new) {
        EXPECT_EQ(place->second.SerializeAsString(), result.SerializeAsString());
      }
      if (++seen == kill_at) service.Kill();
    }
    if (reader->Finish().ok()) return true;
    service.Start();
    return false;
  }

  static void Test(testing::ServiceUnderTest& service) {
    Register(service);
    Results results;
    {
      const Workers workers(service.address());
      EXPECT_FALSE(Ask(service, kTasks / 4, results));
      EXPECT_FALSE(Ask(service, kTasks * 2 / 3, results));
      EXPECT_TRUE(Ask(service, -1, results));
      EXPECT_GE(workers.deaths(), 20);
    }
    ASSERT_EQ(results.size(), static_cast<std::size_t>(kTasks));
    for (const auto& [index, result] : results) {
      ASSERT_EQ(result.metrics_size(), 2);
      EXPECT_EQ(result.metrics(0).value(), static_cast<double>(index) * index);
    }
    v1::GetQueueStatusRequest asked;
    asked.set_evaluator("evaluators/synthetic");
    const auto stub = v1::SimulatorService::NewStub(service.channel());
    const auto status = testing::Call(*stub, &v1::SimulatorService::Stub::GetQueueStatus, asked);
    ASSERT_TRUE(status.ok()) << status.status();
    EXPECT_EQ(status->done(), kTasks);
    EXPECT_EQ(status->queued() + status->leased() + status->quarantined(), 0);
    // Known now, without workers, and just the same.
    EXPECT_TRUE(Ask(service, -1, results));
  }
};

TEST_F(WorkerFaultsTest, NoTaskIsLostOrDoneTwiceOnSqlite) {
  testing::ServiceUnderTest service("mortise-simulator", {"--peer=catalog=127.0.0.1:1"});
  Test(service);
}

TEST_F(WorkerFaultsTest, NoTaskIsLostOrDoneTwiceOnPostgresql) {
  const auto cluster = testing::PrivatePostgresql::Start();
  ASSERT_TRUE(cluster.ok()) << cluster.status();
  testing::ServiceUnderTest service("mortise-simulator", {"--peer=catalog=127.0.0.1:1"},
                                    (*cluster)->url());
  Test(service);
}

// Asked of one replica, leased from it, reported to another: whoever asked is told.
TEST_F(WorkerFaultsTest, AReportMayReachAReplicaThatDidNotLend) {
  const auto cluster = testing::PrivatePostgresql::Start();
  ASSERT_TRUE(cluster.ok()) << cluster.status();
  testing::ServiceUnderTest first("mortise-simulator", {"--peer=catalog=127.0.0.1:1"},
                                  (*cluster)->url());
  testing::ServiceUnderTest second("mortise-simulator", {"--peer=catalog=127.0.0.1:1"},
                                   (*cluster)->url());
  Register(first);
  v1::EvaluateBatchRequest asked = Batch();
  asked.mutable_points()->DeleteSubrange(1, kTasks - 1);
  const auto evaluators = v1::EvaluatorService::NewStub(first.channel());
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto reader = evaluators->EvaluateBatch(&context, asked);

  v1::LeaseTasksRequest lease;
  lease.set_evaluator("evaluators/synthetic");
  lease.set_worker("only");
  lease.set_limit(1);
  lease.set_wait_seconds(30);
  const auto of_first = v1::SimulatorService::NewStub(first.channel());
  const auto leased = testing::Call(*of_first, &v1::SimulatorService::Stub::LeaseTasks, lease);
  ASSERT_TRUE(leased.ok()) << leased.status();
  ASSERT_EQ(leased->tasks_size(), 1);
  v1::ReportTaskRequest report;
  report.mutable_task()->set_name(leased->tasks(0).name());
  report.mutable_task()->set_attempt(leased->tasks(0).attempt());
  for (const char* metric : {"square", "mark"}) {
    v1::Metric& told = *report.mutable_result()->add_metrics();
    told.set_name(metric);
    told.set_value(7);
  }
  const auto of_second = v1::SimulatorService::NewStub(second.channel());
  const auto taken = testing::Call(*of_second, &v1::SimulatorService::Stub::ReportTask, report);
  ASSERT_TRUE(taken.ok()) << taken.status();

  v1::EvaluationResult result;
  ASSERT_TRUE(reader->Read(&result));
  ASSERT_EQ(result.metrics_size(), 2) << result.ShortDebugString();
  EXPECT_EQ(result.metrics(0).value(), 7);
  EXPECT_FALSE(reader->Read(&result));
  EXPECT_TRUE(reader->Finish().ok());
}

}  // namespace
}  // namespace mortise::simulator
