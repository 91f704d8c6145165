// The covers that a build waits for, as tasks in the store that workers lease: threads of the
// service itself, and processes elsewhere. At most one build uses it at a time.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/host/idle_workers.h"
#include "common/store/store.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/service/cover_making.h"

namespace mortise::store {
class BlobFolder;
}

namespace mortise::retrieval {

inline constexpr char kCoverQueue[] = "covers";

// What a worker of the service's own is called: this, and a number.
inline constexpr char kOwnWorker[] = "service-";

// Whether what a renewal fails with says that the task is somebody else's, or nobody's.
bool IsLost(const absl::Status& renewed);

// Thread safe.
class CoverQueue {
 public:
  // All outlive it.
  CoverQueue(store::Store* store, store::BlobFolder* blobs, rpc::Dispatcher* dispatcher);

  // ---- For a build ----

  // Forgets tasks that have ended, and takes those back that workers of the service's own held in a
  // process that is gone.
  absl::Status Begin();

  // Queues a task, unless it waits or is with a worker since before; its key. `name` and `attempt`
  // are set by leases.
  absl::StatusOr<std::string> Enqueue(const v1::CoverTask& task);

  // Cancels what has not ended but for these keys: nobody waits for it any more. Their workers
  // notice when they renew, and their reports are refused; covers that were reported are kept.
  absl::Status CancelOthers(const std::set<std::string>& keys);

  // Returns how many tasks have not ended. Fails with why a task failed that a build cannot do
  // without. Puts aside, as covers with a fault, what ended five workers without a report.
  absl::StatusOr<std::int64_t> CountUnfinished();

  // Whether a task has ended in this build.
  bool HasEnded(const std::string& key) const;

  // Waits until there is something new, at most so long.
  void Wait(absl::Duration timeout);

  // ---- For workers ----

  // Returns a task for the worker, with those covers that are not there yet; nothing if none waits.
  absl::StatusOr<std::optional<v1::CoverTask>> Lease(const std::string& worker,
                                                     absl::Duration lease);

  // As store::Transaction::RenewLease; NOT_FOUND for a task that is forgotten.
  absl::Status Renew(const std::string& key, std::int64_t attempt, absl::Duration lease);

  // Takes what a worker says of its attempt, as RetrievalService.ReportCover has it. `key` is the
  // task's, without "tasks/".
  absl::Status Report(const std::string& key, const v1::ReportCoverRequest& report,
                      absl::Duration lease);

  // Returns who waits for a task.
  rpc::IdleWorkers& idle_workers() { return *idle_workers_; }

 private:
  absl::Status Settle(const std::string& key, std::int64_t attempt, const absl::Status& error);
  absl::StatusOr<v1::ShapeIndex> RecordOf(const v1::CoverTask& task,
                                          const v1::MadeCover& made) const;
  absl::Status PutAside(store::Transaction& transaction, const store::Task& task);
  void Tell(const std::optional<std::string>& ended);

  store::Store* const store_;
  store::BlobFolder* const blobs_;
  const std::shared_ptr<rpc::IdleWorkers> idle_workers_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> ended_;  // keys; guarded by mutex_
  std::uint64_t news_ = 0;       // guarded by mutex_
};

}  // namespace mortise::retrieval
