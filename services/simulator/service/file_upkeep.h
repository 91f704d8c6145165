// What the simulator does by itself, at its start and every hour: it removes files that nothing
// refers to any more, and what was told of the progress of tasks that have ended.
#pragma once

#include <filesystem>
#include <memory>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/store/blob_upkeep.h"

namespace mortise::jobs {
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

// How long a file stays that nothing refers to: an uploaded mesh whose analysis is to be asked for,
// a file of an analysis that failed or was dropped.
inline constexpr absl::Duration kUnusedFileLife = absl::Hours(24);

// How long a part of a file stays that nobody writes to.
inline constexpr absl::Duration kAbandonedPartLife = absl::Hours(1);

// Removes what no analysis, no unfinished operation and no quarantined task names and what is older
// than the above and than an hour before every unfinished operation, whose files are not named
// before it ends.
absl::StatusOr<store::RemovedBlobs> RemoveUnusedFiles(store::Store& store,
                                                      jobs::Operations& operations,
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
  jobs::Operations* const operations_;
  rpc::Dispatcher* const dispatcher_;
  const std::filesystem::path folder_;
};

}  // namespace mortise::simulator
