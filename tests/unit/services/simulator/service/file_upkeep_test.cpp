// Which files of the simulator go, and when.
#include "services/simulator/service/file_upkeep.h"

#include <gtest/gtest.h>
#include <sys/fsuid.h>

#include <atomic>
#include <fstream>

#include "common/base/digest.h"
#include "common/operations/operations.h"
#include "common/store/blob_upkeep.h"
#include "common/store/store.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/service/analysis_operation.h"
#include "services/simulator/service/analysis_records.h"
#include "services/simulator/service/evaluation_tasks.h"
#include "services/simulator/service/task_progress.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/common/store/store_conformance.h"

namespace mortise::simulator {
namespace {

using store::Driver;

class FileUpkeepTest : public ::testing::TestWithParam<Driver> {
 protected:
  FileUpkeepTest() {
    static std::atomic<int> last = 0;
    store::StoreOptions options;
    options.url = GetParam() == Driver::kSqlite ? "sqlite:" + (folder_.path() / "store.db").string()
                                                : store::SharedPostgresqlUrl();
    options.service = "files-" + std::to_string(++last);
    options.blob_folder = blob_folder_;
    options.clock = [this] { return absl::Now() + ahead_; };
    store_ = store::OpenStore(options).value();
    blobs_ = store_->Blobs().value();
    operations_ = operations::Operations::Create({.service = "simulator"}, store_.get()).value();
    // Without Resume none ever runs.
    operations_->Register("analysis", [](operations::OperationContext&) { return ""; });
  }

  // A mesh, or a file of an analysis.
  std::string Upload(const std::string& bytes) { return blobs_->Put(bytes).value(); }

  bool Exists(const std::string& digest) { return blobs_->Size(digest).ok(); }

  void InTransaction(const std::function<absl::Status(store::Transaction&)>& change) {
    EXPECT_OK(store_->Transact(change));
  }

  std::string StartAnalysis(const std::string& mesh_file) {
    v1::Task task;
    task.set_mesh_file(mesh_file);
    std::string name;
    InTransaction([&](store::Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(
          const operations::Operation operation,
          operations_->Start(transaction,
                             {.kind = "analysis", .request = task.SerializeAsString()}));
      name = operation.name;
      return absl::OkStatus();
    });
    return name;
  }

  int RemoveFiles() {
    const auto removed = RemoveUnusedFiles(*store_, *operations_, blob_folder_);
    EXPECT_OK(removed);
    return removed.ok() ? removed->count : -1;
  }

  const testing::TemporaryFolder folder_;
  const std::filesystem::path blob_folder_ = folder_.path() / "blobs";
  absl::Duration ahead_ = absl::ZeroDuration();  // of the store's clock
  std::unique_ptr<store::Store> store_;
  store::BlobFolder* blobs_ = nullptr;
  std::unique_ptr<operations::Operations> operations_;
};

// As on a disk that is only read: the link leads to a file of the administrator's, whose rights
// this thread gives up meanwhile.
TEST(KeepYoungTest, WhatCannotBeTouchedCanBeFetchedAllTheSame) {
  const testing::TemporaryFolder folder;
  const auto blobs = store::BlobFolder::Open(folder.path()).value();
  const std::string digest = Sha256Hex("mesh");
  const std::filesystem::path shelf = folder.path() / digest.substr(0, 2);
  std::filesystem::create_directory(shelf);
  std::filesystem::create_symlink("/etc/passwd", shelf / digest);
  for (const std::filesystem::path& path : {folder.path(), shelf}) {
    std::filesystem::permissions(path, static_cast<std::filesystem::perms>(0755));
  }
  constexpr int kNobody = 65534;
  const int own = ::setfsuid(kNobody);
  const absl::Status touched = store::TouchBlob(*blobs, digest);
  const absl::Status kept = KeepYoung(*blobs, digest);
  ::setfsuid(static_cast<uid_t>(own));
  EXPECT_TRUE(absl::IsInternal(touched)) << touched;
  EXPECT_OK(kept);
  EXPECT_TRUE(absl::IsNotFound(KeepYoung(*blobs, Sha256Hex("none"))));
  EXPECT_TRUE(absl::IsInvalidArgument(KeepYoung(*blobs, "none")));
}

TEST_P(FileUpkeepTest, AnUploadThatNobodyAnalysesGoesAfterADay) {
  const std::string mesh = Upload("mesh");
  ahead_ = absl::Hours(23);
  EXPECT_EQ(RemoveFiles(), 0);
  EXPECT_TRUE(Exists(mesh));
  ahead_ = absl::Hours(25);
  EXPECT_EQ(RemoveFiles(), 1);
  EXPECT_FALSE(Exists(mesh));
}

TEST_P(FileUpkeepTest, WhatAnAnalysisNamesStays) {
  v1::Analysis analysis;
  analysis.set_mesh_file(Upload("mesh"));
  analysis.add_artifacts()->set_sha256(Upload("picture"));
  InTransaction([&](store::Transaction& transaction) {
    return transaction.Put(kAnalyses.kind, "finished", analysis.SerializeAsString()).status();
  });
  ahead_ = absl::Hours(1000);
  EXPECT_EQ(RemoveFiles(), 0);
  EXPECT_TRUE(Exists(analysis.mesh_file()));
}

TEST_P(FileUpkeepTest, FilesOfUnfinishedWorkStayUntilItEnds) {
  const std::string other = Upload("of nobody");
  std::filesystem::last_write_time(
      blobs_->PathOf(other).value(),
      std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
  const std::string mesh = Upload("mesh");
  const std::string analysis = StartAnalysis(mesh);
  // What its worker has uploaded so far is named nowhere yet.
  const std::string picture = Upload("picture");
  ahead_ = absl::Hours(30);
  EXPECT_EQ(RemoveFiles(), 1);
  EXPECT_FALSE(Exists(other));
  EXPECT_TRUE(Exists(mesh));
  EXPECT_TRUE(Exists(picture));
  EXPECT_OK(operations_->Cancel(analysis).status());
  EXPECT_EQ(RemoveFiles(), 2);
}

TEST_P(FileUpkeepTest, TheInputOfAQuarantinedTaskStays) {
  v1::Task task;
  task.set_mesh_file(Upload("poison"));
  const std::string key = std::string(kAnalysisTaskPrefix) + "poison";
  InTransaction([&](store::Transaction& transaction) {
    return transaction.EnqueueTask({.queue = kSimulatorQueue,
                                    .key = key,
                                    .payload = task.SerializeAsString(),
                                    .max_attempts = 1});
  });
  for (int lease = 0; lease < 2; ++lease) {
    InTransaction([&](store::Transaction& transaction) {
      return transaction.LeaseTasks(kSimulatorQueue, "victim", 1, absl::Seconds(1)).status();
    });
    ahead_ += absl::Hours(30);
  }
  EXPECT_EQ(RemoveFiles(), 0);
  EXPECT_TRUE(Exists(task.mesh_file()));
}

TEST_P(FileUpkeepTest, ProgressOfTasksThatEndedIsForgotten) {
  v1::TaskAttempt told;
  told.set_attempt(1);
  told.mutable_progress()->set_total(1);
  for (const std::string key : {"ended", "gone", "waits"}) {
    InTransaction([&](store::Transaction& transaction) -> absl::Status {
      MORTISE_RETURN_IF_ERROR(KeepProgress(transaction, key, told));
      if (key == "gone") return absl::OkStatus();
      MORTISE_RETURN_IF_ERROR(transaction.EnqueueTask({.queue = kSimulatorQueue, .key = key}));
      return key == "ended" ? transaction.CancelTask(kSimulatorQueue, key) : absl::OkStatus();
    });
  }
  EXPECT_EQ(RemoveOldProgress(*store_).value(), 2);
  EXPECT_EQ(RemoveOldProgress(*store_).value(), 0);
}

INSTANTIATE_TEST_SUITE_P(Stores, FileUpkeepTest,
                         ::testing::Values(Driver::kSqlite, Driver::kPostgresql),
                         store::DriverName);

}  // namespace
}  // namespace mortise::simulator
