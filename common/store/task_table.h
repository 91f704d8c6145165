// The task queue of a store, in SQL.
//
// A task's `attempt` rises with every lease and is the fencing token; `counted_attempts` leaves out
// the leases that were given back unharmed, or ran out before their worker came to them, and is
// what max_attempts limits. `worker` is empty while no attempt may still report: before the first
// lease, and after one was failed or released. Queue calls lock the rows they change, so that they
// are right at every isolation.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/store/sql.h"
#include "common/store/types.h"

namespace mortise::store {

// The methods are those of Transaction.
class TaskTable {
 public:
  TaskTable(SqlConnection* connection, absl::Time now) : connection_(connection), now_(now) {}

  absl::StatusOr<Task> Get(std::string_view queue, std::string_view key);
  absl::StatusOr<std::vector<Task>> List(std::string_view queue, const ListOptions& options);
  absl::StatusOr<QueueDepth> Depth(std::string_view queue);

  absl::Status Enqueue(const NewTask& task);
  absl::StatusOr<std::vector<bool>> EnqueueAll(const std::vector<NewTask>& tasks);
  absl::StatusOr<LeaseResult> Lease(std::string_view queue, std::string_view worker, int limit,
                                    absl::Duration lease);
  absl::Status Renew(std::string_view queue, std::string_view key, int64_t attempt,
                     absl::Duration lease);
  absl::StatusOr<Task> Complete(std::string_view queue, std::string_view key, int64_t attempt,
                                std::string_view result);
  absl::Status Fail(std::string_view queue, std::string_view key, int64_t attempt,
                    std::string_view error, bool retry, absl::Duration delay);
  absl::Status Release(std::string_view queue, std::string_view key, int64_t attempt);
  absl::StatusOr<int64_t> ExpireLeases(std::string_view queue, std::string_view worker);
  absl::Status Cancel(std::string_view queue, std::string_view key);
  absl::Status Delete(std::string_view queue, std::string_view key);

 private:
  // What decides whether a report is accepted.
  struct Standing {
    TaskState state = TaskState::kQueued;
    int64_t attempt = 0;
    int64_t counted_attempts = 0;
    int64_t max_attempts = 0;
    bool reportable = false;  // some attempt may still report
  };

  absl::StatusOr<Standing> LockStanding(std::string_view queue, std::string_view key);

  // Whether `attempt` may still report on a task.
  static absl::Status CheckReportable(const Standing& standing, std::string_view queue,
                                      std::string_view key, int64_t attempt);

  // Locks the task and checks that.
  absl::Status LockForReport(std::string_view queue, std::string_view key, int64_t attempt);

  absl::StatusOr<bool> HasExpired(std::string_view queue);
  absl::Status RequeueExpired(std::string_view queue);
  // After RequeueExpired, which needs to see what the same workers held.
  absl::StatusOr<std::vector<Task>> QuarantineExpired(std::string_view queue);
  int64_t After(absl::Duration duration) const;

  SqlConnection* connection_;
  absl::Time now_;
};

}  // namespace mortise::store
