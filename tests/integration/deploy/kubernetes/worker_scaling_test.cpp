// What scales workers in deploy/kubernetes: its queries on the store of a real simulator and on
// that of retrieval, and the limits of those it starts.
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <string>

#include "common/store/store.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "services/retrieval/service/cover_queue.h"
#include "tests/e2e/command.h"
#include "tests/integration/deploy/kubernetes/manifests.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/service_under_test.h"
#include "tests/support/mesh_files.h"
#include "tests/support/private_postgresql.h"

namespace mortise::testing {
namespace {

class WorkerScalingTest : public ::testing::Test {
 protected:
  Json Trigger(const std::string& workers) const {
    const Json scaled = manifests_.Find("ScaledObject", workers);
    return scaled.is_null() ? Json::object() : scaled["spec"]["triggers"][0];
  }

  // What the query that scales workers finds in a store.
  std::string Depth(const std::string& workers, const std::string& store) const {
    const std::string query = Trigger(workers)["metadata"]["query"];
    const e2e::CommandResult result = e2e::Shell(
        "psql --no-psqlrc --tuples-only --no-align '" + store + "' <<< \"" + query + "\"", "/");
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.out;
  }

  // Takes a task as a worker would; waits until there is one.
  static v1::Task Lease(v1::SimulatorService::Stub& simulator) {
    v1::LeaseTasksRequest request;
    request.set_worker("played");
    request.set_limit(1);
    request.set_lease_seconds(3600);
    request.set_wait_seconds(60);
    const auto leased = Call(simulator, &v1::SimulatorService::Stub::LeaseTasks, request);
    EXPECT_TRUE(leased.ok() && leased->tasks_size() == 1) << leased.status();
    return leased.ok() && leased->tasks_size() == 1 ? leased->tasks(0) : v1::Task();
  }

  const Manifests manifests_;
};

TEST_F(WorkerScalingTest, ScalesTheWorkersOnTheStoreThatTheirServiceHas) {
  for (const std::string service : {"simulator", "retrieval"}) {
    SCOPED_TRACE(service);
    const std::string workers = service + "-worker";
    const Json scaled = manifests_.Find("ScaledObject", workers);
    ASSERT_FALSE(scaled.is_null());
    const std::string target = scaled["spec"]["scaleTargetRef"]["name"];
    EXPECT_EQ(target, workers);
    EXPECT_EQ(manifests_.workload(target).document["kind"], "Deployment");
    EXPECT_FALSE(manifests_.workload(target).document["spec"].contains("replicas"))
        << "applying the manifests again would undo the scaling";
    const Json trigger = Trigger(workers);
    const Json store = trigger["metadata"];
    EXPECT_EQ(trigger["type"], "postgresql");
    const std::string name_space = manifests_.kustomization()["namespace"];
    EXPECT_EQ(store["host"], "postgres." + name_space + ".svc.cluster.local");
    EXPECT_EQ(manifests_.workload(service).environment["MORTISE_STORE"],
              "postgresql://" + store["userName"].get<std::string>() + "@postgres/" +
                  store["dbName"].get<std::string>());
    EXPECT_EQ(std::to_string(manifests_.workload("postgres").ports["postgresql"].get<int>()),
              store["port"]);
    EXPECT_FALSE(
        manifests_.Find("TriggerAuthentication", trigger["authenticationRef"]["name"]).is_null());
  }
}

TEST_F(WorkerScalingTest, QueryCountsTheCoversThatWaitOrAreWorkedOn) {
  const auto cluster = PrivatePostgresql::Start();
  ASSERT_TRUE(cluster.ok()) << cluster.status();
  const auto store = store::OpenStore({.url = (*cluster)->url(), .service = "retrieval"});
  ASSERT_TRUE(store.ok()) << store.status();
  const auto change = [&](const std::function<absl::Status(store::Transaction&)>& what) {
    const absl::Status changed = (*store)->Transact(what);
    EXPECT_TRUE(changed.ok()) << changed;
    return Depth("retrieval-worker", (*cluster)->url());
  };
  constexpr const char* kQueue = retrieval::kCoverQueue;
  EXPECT_EQ(change([](store::Transaction& transaction) {
              return transaction
                  .EnqueueTasks({{.queue = kQueue, .key = "one"}, {.queue = kQueue, .key = "two"}})
                  .status();
            }),
            "2\n");
  EXPECT_EQ(change([](store::Transaction& transaction) {
              return transaction.LeaseTasks(kQueue, "played", 1, absl::Hours(1)).status();
            }),
            "2\n");
  EXPECT_EQ(change([](store::Transaction& transaction) {
              return transaction.CompleteTask(kQueue, "one", 1, "").status();
            }),
            "1\n");
}

TEST_F(WorkerScalingTest, QueryCountsTheTasksThatWaitOrAreWorkedOn) {
  const auto cluster = PrivatePostgresql::Start();
  ASSERT_TRUE(cluster.ok()) << cluster.status();
  ServiceUnderTest service("mortise-simulator", {"--peer=catalog=127.0.0.1:1"}, (*cluster)->url());
  const auto depth = [&] { return Depth("simulator-worker", (*cluster)->url()); };
  EXPECT_EQ(depth(), "0\n");

  const auto simulator = v1::SimulatorService::NewStub(service.channel());
  const std::string mesh = WriteGmsh41(GroupedBox({1, 1, 1}, {1, 1, 1}, false), true);
  grpc::ClientContext uploading;
  v1::UploadBlobResponse uploaded;
  const auto writer = simulator->UploadBlob(&uploading, &uploaded);
  v1::Chunk chunk;
  chunk.set_data(mesh);
  chunk.set_total_size(static_cast<int64_t>(mesh.size()));
  writer->Write(chunk);
  writer->WritesDone();
  ASSERT_TRUE(writer->Finish().ok());
  v1::AnalyzeMeshRequest analyze;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(
      "case { length_unit: 'm' materials { values { density: 500 youngs_modulus: 1e9 "
      "poissons_ratio: 0.3 } }"
      " supports { groups: 'x_min' fixed: true } load_cases { name: 'weight' gravity { z: -9.8 } } "
      "}",
      &analyze));
  analyze.set_mesh_file(uploaded.sha256());
  for (const char* id : {"one", "two"}) {
    analyze.set_request_id(id);
    const auto started = Call(*simulator, &v1::SimulatorService::Stub::AnalyzeMesh, analyze);
    ASSERT_TRUE(started.ok()) << started.status();
  }
  const v1::Task first = Lease(*simulator);
  Lease(*simulator);
  EXPECT_EQ(depth(), "2\n");
  // One goes back to the queue, and one ends.
  const auto report = [&](const v1::Task& task, const std::string& error) {
    v1::ReportTaskRequest request;
    request.mutable_task()->set_name(task.name());
    request.mutable_task()->set_attempt(task.attempt());
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
        error, request.mutable_result()->mutable_error()));
    const auto told = Call(*simulator, &v1::SimulatorService::Stub::ReportTask, request);
    EXPECT_TRUE(told.ok()) << told.status();
  };
  report(first, "code: 1 message: 'the worker ends'");
  EXPECT_EQ(depth(), "2\n");
  report(Lease(*simulator), "code: 13 message: 'it cannot be computed'");
  EXPECT_EQ(depth(), "1\n");
}

TEST_F(WorkerScalingTest, WorkersKeepToTheirContainer) {
  const Workload& worker = manifests_.workload("simulator-worker");
  const Json& limits = worker.container["resources"]["limits"];
  const std::string memory = limits["memory"];
  ASSERT_EQ(memory.substr(memory.size() - 2), "Gi");
  const double container = std::atof(memory.c_str()) * 1.073741824;  // GB
  const double task =
      std::atof(worker.environment["MORTISE_MEMORY_LIMIT"].get<std::string>().c_str());
  EXPECT_LE(task, 0.9 * container);
  EXPECT_GE(task, 0.8 * container);
  EXPECT_EQ(worker.Values("--solver-threads").at(0), limits["cpu"]);
  EXPECT_EQ(worker.environment["OPENBLAS_NUM_THREADS"], "1");
  EXPECT_EQ(worker.container["resources"]["requests"], limits);
}

}  // namespace
}  // namespace mortise::testing
