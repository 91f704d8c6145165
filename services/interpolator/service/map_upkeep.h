// What the service does by itself: it marks maps whose subject has changed, and removes files that
// no map names any more.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/repeated_work.h"
#include "common/host/run_service.h"
#include "common/rpc/channel.h"
#include "common/store/blob_upkeep.h"
#include "common/store/store.h"

namespace mortise::interpolator {

// Follows the catalog's events about templates and the simulator's about evaluators. When one has
// come, changed or gone, the maps of it that are of another revision than its latest become stale;
// what was missed while others or this service were away is noticed when they meet again.
class StaleUpkeep {
 public:
  // The environment outlives it. PEER_UNKNOWN, FAILED_PRECONDITION where the house has no catalog
  // or no simulator.
  static absl::StatusOr<std::unique_ptr<StaleUpkeep>> Start(rpc::ServiceEnvironment& environment);
  ~StaleUpkeep();

  // Has maps of these subjects looked at soon.
  void Notice(const std::set<std::string>& subjects);

 private:
  StaleUpkeep(rpc::ServiceEnvironment& environment, std::shared_ptr<grpc::Channel> catalog,
              std::shared_ptr<grpc::Channel> simulator);

  void Follow(const std::stop_token& stop, const std::shared_ptr<grpc::Channel>& channel,
              const std::string& stream, const std::string& types);
  void Check(const std::stop_token& stop);
  absl::Status CheckSubject(const std::string& subject);
  absl::Status NoticeAll();
  rpc::Origin Origin(absl::Duration timeout) const;

  rpc::ServiceEnvironment& environment_;
  const std::shared_ptr<grpc::Channel> catalog_;
  const std::shared_ptr<grpc::Channel> simulator_;
  std::mutex mutex_;
  std::condition_variable_any noticed_;
  std::set<std::string> subjects_;  // that may have changed; guarded by mutex_
  std::jthread catalog_follower_;
  std::jthread simulator_follower_;
  std::jthread checker_;
};

// Returns how much disk all maps take, as they say: bytes.
absl::StatusOr<std::int64_t> BytesOfMaps(store::Store& store);

// Removes files of maps that were deleted, and of builds that did not come to an end, as
// rpc::RemoveUnusedFiles does.
absl::StatusOr<store::RemovedBlobs> RemoveUnusedFiles(store::Store& store,
                                                      operations::Operations& operations,
                                                      const std::filesystem::path& folder);

// Does that at the start and every hour. What fails is logged; the next time comes.
class FileUpkeep {
 public:
  explicit FileUpkeep(const rpc::ServiceEnvironment& environment);

 private:
  const RepeatedWork work_;
};

}  // namespace mortise::interpolator
