// What the simulator does by itself, at its start and every hour: it removes files that nothing
// refers to any more, and what was told of the progress of tasks that have ended.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/host/unused_files.h"
#include "common/store/blob_upkeep.h"

namespace mortise::operations {
class Operations;
}
namespace mortise::rpc {
class Dispatcher;
struct ServiceEnvironment;
}  // namespace mortise::rpc
namespace mortise::store {
class Store;
}

namespace mortise::simulator {

// The files that stay: those that analyses, unfinished operations and quarantined tasks name.
rpc::NamedFiles FilesInUse();

// Makes a file as new as if it had just been written, so that it stays. NOT_FOUND;
// INVALID_ARGUMENT. One that is there but cannot be touched, as on a disk that is only read, is
// logged, and OK: whoever wants it can have it.
absl::Status KeepYoung(store::BlobFolder& blobs, const std::string& sha256);

// Removes all others, as rpc::RemoveUnusedFiles does.
absl::StatusOr<store::RemovedBlobs> RemoveUnusedFiles(store::Store& store,
                                                      operations::Operations& operations,
                                                      const std::filesystem::path& folder);

// Removes the progress of tasks that have ended or are gone; returns how many.
absl::StatusOr<int> RemoveOldProgress(store::Store& store);

class FileUpkeep : public std::enable_shared_from_this<FileUpkeep> {
 public:
  // Does both at once and every hour, on the handlers' threads, until the last reference goes. What
  // fails is logged; the next time comes.
  static std::shared_ptr<FileUpkeep> Start(const rpc::ServiceEnvironment& environment);

 private:
  explicit FileUpkeep(const rpc::ServiceEnvironment& environment);
  void RunAfter(absl::Duration delay);
  void TidyUp();

  store::Store* const store_;
  operations::Operations* const operations_;
  rpc::Dispatcher* const dispatcher_;
  const std::filesystem::path folder_;
};

}  // namespace mortise::simulator
