#include "services/simulator/service/file_upkeep.h"

#include <set>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/host/run_service.h"
#include "common/host/unused_files.h"
#include "common/operations/operations.h"
#include "common/rpc/dispatcher.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/service/analysis_operation.h"
#include "services/simulator/service/analysis_records.h"
#include "services/simulator/service/evaluation_tasks.h"
#include "services/simulator/service/task_progress.h"

namespace mortise::simulator {
namespace {

constexpr absl::Duration kPause = absl::Hours(1);
constexpr int kPage = 100;

absl::Status AddAnalyses(store::ReadTransaction& read, std::set<std::string>* named) {
  store::ListOptions list{.limit = kPage};
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const auto page, read.List(kAnalyses.kind, list));
    for (const store::Record& record : page) {
      MORTISE_ASSIGN_OR_RETURN(const auto analysis,
                               resources::ParseRecord<v1::Analysis>(kAnalyses.kind, record));
      named->insert(analysis.mesh_file());
      for (const v1::Artifact& artifact : analysis.artifacts()) named->insert(artifact.sha256());
    }
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
    list.after_key = page.back().key;
  }
}

// Their input is kept for whoever looks into them.
absl::Status AddQuarantined(store::ReadTransaction& read, std::set<std::string>* named) {
  store::ListOptions list{.key_prefix = kAnalysisTaskPrefix, .limit = kPage};
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const auto page, read.ListTasks(kSimulatorQueue, list));
    for (const store::Task& stored : page) {
      v1::Task task;
      if (stored.state != store::TaskState::kQuarantined) continue;
      if (task.ParseFromString(stored.payload)) named->insert(task.mesh_file());
    }
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
    list.after_key = page.back().key;
  }
}

}  // namespace

rpc::NamedFiles FilesInUse() {
  rpc::NamedFiles files;
  files.by_operation = [](const operations::Operation& operation, std::set<std::string>* named) {
    v1::Task task;
    if (task.ParseFromString(operation.request)) named->insert(task.mesh_file());
  };
  files.by_store = [](store::ReadTransaction& read, std::set<std::string>* named) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(AddAnalyses(read, named));
    return AddQuarantined(read, named);
  };
  return files;
}

absl::Status KeepYoung(store::BlobFolder& blobs, const std::string& sha256) {
  const absl::Status touched = store::TouchBlob(blobs, sha256);
  if (touched.ok() || absl::IsNotFound(touched) || absl::IsInvalidArgument(touched)) return touched;
  Log(LogLevel::kWarning, "a file could not be touched, and may go before its time",
      {{"sha256", sha256}, {"error", touched.ToString()}});
  return absl::OkStatus();
}

absl::StatusOr<store::RemovedBlobs> RemoveUnusedFiles(store::Store& store,
                                                      operations::Operations& operations,
                                                      const std::filesystem::path& folder) {
  return rpc::RemoveUnusedFiles(store, operations, folder, FilesInUse());
}

absl::StatusOr<int> RemoveOldProgress(store::Store& store) {
  std::vector<std::string> old;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& read) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(old, FindOldProgress(read));
    return absl::OkStatus();
  }));
  for (const std::string& key : old) {
    MORTISE_RETURN_IF_ERROR(store.Transact(
        [&](store::Transaction& transaction) { return ForgetProgress(transaction, key); }));
  }
  return static_cast<int>(old.size());
}

FileUpkeep::FileUpkeep(const rpc::ServiceEnvironment& environment)
    : store_(environment.store),
      operations_(environment.operations),
      dispatcher_(environment.dispatcher),
      folder_(environment.options.blobs) {}

std::shared_ptr<FileUpkeep> FileUpkeep::Start(const rpc::ServiceEnvironment& environment) {
  std::shared_ptr<FileUpkeep> upkeep(new FileUpkeep(environment));
  upkeep->RunAfter(absl::ZeroDuration());
  return upkeep;
}

void FileUpkeep::RunAfter(absl::Duration delay) {
  dispatcher_->SubmitAfter(delay, [weak = weak_from_this()] {
    const auto upkeep = weak.lock();
    if (upkeep == nullptr) return;
    upkeep->TidyUp();
    upkeep->RunAfter(kPause);
  });
}

void FileUpkeep::TidyUp() {
  const auto files = RemoveUnusedFiles(*store_, *operations_, folder_);
  if (!files.ok()) {
    Log(LogLevel::kWarning, "unused files could not be removed",
        {{"error", files.status().ToString()}});
  } else if (files->count > 0) {
    Log(LogLevel::kInfo, "removed files that nothing refers to",
        {{"files", files->count}, {"bytes", files->bytes}});
  }
  if (const auto old = RemoveOldProgress(*store_); !old.ok()) {
    Log(LogLevel::kWarning, "the progress of old tasks could not be removed",
        {{"error", old.status().ToString()}});
  }
}

}  // namespace mortise::simulator
