// Covers on several workers, as real processes: the same index to the bit on any number, also where
// workers and the service are killed, and what a worker may say of which task.
#include <gtest/gtest.h>
#include <signal.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/store/store.h"
#include "services/retrieval/catalog/template_source.h"
#include "services/retrieval/service/cover_making.h"
#include "services/retrieval/service/cover_queue.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/retrieval/retrieval_house.h"

namespace mortise::retrieval {
namespace {

using testing::BuiltState;
using testing::Call;
using testing::kCoarse;
using testing::RetrievalHouse;
using Stub = v1::RetrievalService::Stub;

const std::vector<std::string> kLeavesAllToWorkers = {"--cover-threads=0"};

// A worker process of the house.
class Worker {
 public:
  Worker(RetrievalHouse& house, const std::string& name)
      : process_({testing::BuiltProgram("mortise-retrieval"), "--worker", "--worker-name=" + name,
                  "--insecure-development", "--log-level=warning", "--lease-seconds=2",
                  "--peer=retrieval=" + house.service().address(),
                  "--peer=catalog=" + house.catalog_process().address()}) {}

  void Kill() { process_.End(SIGKILL); }
  int EndWell() { return process_.End(SIGTERM); }

 private:
  testing::ChildProcess process_;
};

// The worker that has a task, once one of this name does.
bool AwaitLeaseOf(const std::string& worker, RetrievalHouse& house) {
  const auto store =
      store::OpenStore({.url = "sqlite:" + (house.service().folder() / "store.db").string(),
                        .service = "retrieval"});
  EXPECT_TRUE(store.ok()) << store.status();
  const absl::Time deadline = absl::Now() + absl::Seconds(60);
  bool has_task = false;
  while (store.ok() && !has_task && absl::Now() < deadline) {
    const absl::Status read = (*store)->Read([&](store::ReadTransaction& transaction) {
      MORTISE_ASSIGN_OR_RETURN(const auto tasks, transaction.ListTasks(kCoverQueue, {}));
      for (const store::Task& task : tasks) {
        has_task |= task.state == store::TaskState::kLeased && task.worker == worker;
      }
      return absl::OkStatus();
    });
    EXPECT_TRUE(read.ok()) << read;
  }
  return has_task;
}

// What an index has that the service made by itself.
std::string DigestWithoutWorkers() { return BuiltState::House()->Index()->sha256(); }

TEST(CoverWorkersTest, TwoWorkersGiveTheSameBitsAsNone) {
  RetrievalHouse house(kLeavesAllToWorkers);
  Worker first(house, "first"), second(house, "second");
  const v1::Operation built = house.Build("built", kCoarse);
  EXPECT_EQ(house.Index()->sha256(), DigestWithoutWorkers());
  EXPECT_EQ(built.progress().total(), 2);
  EXPECT_EQ(built.progress().done(), 2);
  EXPECT_EQ(first.EndWell(), 0);
  EXPECT_EQ(second.EndWell(), 0);
}

TEST(CoverWorkersTest, WorkersAndServiceThatAreKilledChangeNothing) {
  RetrievalHouse house(kLeavesAllToWorkers);
  const auto started = house.StartBuild("built", kCoarse);
  ASSERT_TRUE(started.ok()) << started.status();
  Worker first(house, "first");
  ASSERT_TRUE(AwaitLeaseOf("first", house));
  first.Kill();
  Worker second(house, "second");
  ASSERT_TRUE(AwaitLeaseOf("second", house));
  Worker third(house, "third");
  house.KillAndStart();
  third.Kill();
  const auto done = house.Await(started->name());
  ASSERT_TRUE(done.ok()) << done.status();
  ASSERT_EQ(done->state(), v1::Operation::SUCCEEDED) << done->ShortDebugString();
  EXPECT_EQ(house.Index()->sha256(), DigestWithoutWorkers());
}

// A worker that the test plays.
class PlayedWorker {
 public:
  explicit PlayedWorker(RetrievalHouse& house)
      : house_(house), templates_(house.catalog_process().channel()) {}

  absl::StatusOr<v1::LeaseCoverResponse> Ask(const std::string& version = kCoverVersion,
                                             double wait_seconds = 60) {
    v1::LeaseCoverRequest request;
    request.set_worker("played");
    request.set_cover_version(version);
    request.set_lease_seconds(3600);
    request.set_wait_seconds(wait_seconds);
    return Call(house_.retrieval(), &Stub::LeaseCover, request);
  }

  v1::CoverTask Lease() {
    const auto leased = Ask();
    EXPECT_TRUE(leased.ok() && leased->has_task()) << leased.status();
    return leased.ok() ? leased->task() : v1::CoverTask();
  }

  // Makes its only cover, and keeps what would be reported.
  v1::ReportCoverRequest Make(const v1::CoverTask& task) {
    v1::ReportCoverRequest report;
    const absl::Status made =
        MakeCovers(task, templates_, {}, {}, [&](CoverFile file, bool last) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(*file.made.mutable_sha256(), Upload(file.bytes));
          *report.mutable_cover() = file.made;
          report.set_last(last);
          return absl::OkStatus();
        });
    EXPECT_TRUE(made.ok()) << made;
    report.set_task(task.name());
    report.set_attempt(task.attempt());
    return report;
  }

  absl::Status Report(const v1::ReportCoverRequest& report) {
    return Call(house_.retrieval(), &Stub::ReportCover, report).status();
  }

  bool HasLost(const v1::CoverTask& task) {
    v1::RenewCoverRequest renew;
    renew.set_task(task.name());
    renew.set_attempt(task.attempt());
    const auto renewed = Call(house_.retrieval(), &Stub::RenewCover, renew);
    EXPECT_TRUE(renewed.ok()) << renewed.status();
    return renewed.ok() && renewed->lost();
  }

 private:
  absl::StatusOr<std::string> Upload(const std::string& bytes) {
    grpc::ClientContext context;
    testing::Prepare(context);
    v1::UploadCoverResponse response;
    const auto writer = house_.retrieval().UploadCover(&context, &response);
    v1::Chunk chunk;
    chunk.set_total_size(static_cast<int64_t>(bytes.size()));
    chunk.set_data(bytes);
    writer->Write(chunk);
    writer->WritesDone();
    MORTISE_RETURN_IF_ERROR(rpc::FromGrpc(writer->Finish()));
    return response.sha256();
  }

  RetrievalHouse& house_;
  TemplateSource templates_;
};

TEST(CoverWorkersTest, ACancelledBuildKeepsWhatWasReportedAndRefusesWhatComesLate) {
  RetrievalHouse house(kLeavesAllToWorkers);
  PlayedWorker worker(house);
  auto started = house.StartBuild("first", kCoarse);
  ASSERT_TRUE(started.ok()) << started.status();
  const v1::CoverTask one = worker.Lease();
  const v1::CoverTask other = worker.Lease();
  ASSERT_NE(one.family().template_(), other.family().template_());
  ASSERT_EQ(one.covers_size(), 1);
  v1::ReportCoverRequest wrong = worker.Make(one);
  const v1::ReportCoverRequest right = wrong;
  EXPECT_TRUE(worker.Report(right).ok());
  EXPECT_TRUE(worker.Report(right).ok()) << "a report that was sent again";
  wrong.set_attempt(2);
  EXPECT_TRUE(absl::IsAborted(worker.Report(wrong)));

  const v1::ReportCoverRequest late = worker.Make(other);
  EXPECT_FALSE(worker.HasLost(other));
  v1::CancelOperationRequest cancel;
  cancel.set_request_id("no-more");
  cancel.set_name(started->name());
  const auto operations = v1::OperationService::NewStub(house.channel());
  ASSERT_TRUE(Call(*operations, &v1::OperationService::Stub::CancelOperation, cancel).ok());
  const auto cancelled = house.Await(started->name());
  ASSERT_TRUE(cancelled.ok()) << cancelled.status();
  EXPECT_EQ(cancelled->state(), v1::Operation::CANCELLED);
  EXPECT_TRUE(worker.HasLost(other));
  EXPECT_EQ(DetailOf(worker.Report(late)).reason, "TASK_CANCELLED");
  EXPECT_TRUE(absl::IsNotFound(house.Index().status()));

  // The next build asks for what is missing alone.
  started = house.StartBuild("second", kCoarse);
  ASSERT_TRUE(started.ok()) << started.status();
  const v1::CoverTask again = worker.Lease();
  EXPECT_EQ(again.family().template_(), other.family().template_());
  v1::ReportCoverRequest report = late;
  report.set_task(again.name());
  report.set_attempt(again.attempt());
  EXPECT_TRUE(worker.Report(report).ok());
  house.End(started);
  EXPECT_EQ(house.Index()->sha256(), DigestWithoutWorkers());
}

TEST(CoverWorkersTest, RefusesWhatNobodyAskedFor) {
  RetrievalHouse house(kLeavesAllToWorkers);
  PlayedWorker worker(house);
  EXPECT_EQ(DetailOf(worker.Ask("cover 0").status()).reason, "WORKER_VERSION");
  const auto none = worker.Ask(kCoverVersion, 0);
  ASSERT_TRUE(none.ok()) << none.status();
  EXPECT_FALSE(none->has_task());
  v1::BuildIndexRequest request;
  request.set_request_id("boat");
  request.add_shape_descriptors(v1::D2);
  request.set_delta(kCoarse);
  request.add_templates("templates/boat");
  const auto started = house.StartBuild(request);
  ASSERT_TRUE(started.ok()) << started.status();
  v1::CoverTask task = worker.Lease();

  v1::ReportCoverRequest report;
  report.set_task("tasks/none");
  report.set_attempt(1);
  EXPECT_EQ(DetailOf(worker.Report(report)).field, "task");
  report.set_task(task.name());
  EXPECT_EQ(DetailOf(worker.Report(report)).field, "cover");
  report.mutable_cover()->set_digest("another");
  EXPECT_EQ(DetailOf(worker.Report(report)).field, "cover.digest");
  // It goes to another worker, as does one whose file is no cover.
  task = worker.Lease();
  EXPECT_EQ(task.attempt(), 2);
  report = worker.Make(task);
  v1::ReportCoverRequest damaged = report;
  damaged.mutable_cover()->set_sha256(std::string(64, '0'));
  EXPECT_EQ(DetailOf(worker.Report(damaged)).field, "cover.sha256");
  task = worker.Lease();
  EXPECT_TRUE(absl::IsAborted(worker.Report(report)));
  report.set_attempt(task.attempt());
  EXPECT_TRUE(worker.Report(report).ok());
  const v1::Operation done = house.End(started);
  EXPECT_EQ(done.progress().total(), 1) << "of the templates that were named";
  EXPECT_EQ(house.Index()->family_count(), 1);
}

}  // namespace
}  // namespace mortise::retrieval
