// One run of one operation: what its handler sees, and what the dispatcher needs to know of it.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "common/operations/operation_records.h"
#include "common/operations/operations.h"
#include "common/store/store.h"

namespace mortise::operations {

// Where a run stands in the task queue; the attempt is its fencing token.
struct RunLease {
  std::string queue;
  std::string id;  // of task and operation
  int64_t attempt = 0;
  absl::Duration duration;
};

class OperationRun final : public OperationContext {
 public:
  OperationRun(const RunLease& lease, const Operation& operation, std::string checkpoint,
               store::Store* store, OperationRecords* records);

  // For the handler.
  const std::string& name() const override { return operation_.name; }
  const std::string& request() const override { return operation_.request; }
  const Operation& operation() const override { return operation_; }
  bool Cancelled() const override { return stop_.stop_requested(); }
  std::stop_token stop_token() const override { return stop_.get_token(); }
  void ReportProgress(const Progress& progress) override;
  void KeepResult(std::string_view result) override;
  absl::Status SaveCheckpoint(std::string_view bytes) override;
  const std::string& checkpoint() const override { return checkpoint_; }
  absl::Status Transact(const std::function<absl::Status(store::Transaction&)>& change) override;
  absl::Status TransactWithCheckpoint(
      const std::function<absl::Status(store::Transaction&)>& change,
      std::string_view checkpoint) override;

  // For the dispatcher. Thread safe.
  const std::string& trace_id() const { return operation_.trace_id; }
  const RunLease& lease() const { return lease_; }
  void Cancel() { stop_.request_stop(); }  // somebody cancelled the operation
  void Interrupt();                        // the process shuts down, or the lease is lost
  void LoseLease();
  bool interrupted() const { return interrupted_; }
  bool lost() const { return lost_; }

  // Returns the progress reported since the last call, if any.
  std::optional<Progress> TakeProgress();

  // Returns the last progress reported, taken or not.
  std::optional<Progress> last_progress();

  std::string kept_result();

  // Runs `change` in a transaction that holds only if this run still owns the operation, and
  // extends its lease.
  absl::Status TransactAsOwner(const std::function<absl::Status(store::Transaction&)>& change);

 private:
  const RunLease lease_;
  const Operation operation_;  // when the run began
  const std::string checkpoint_;
  store::Store* const store_;
  OperationRecords* const records_;
  std::stop_source stop_;
  std::atomic<bool> interrupted_ = false;
  std::atomic<bool> lost_ = false;
  std::mutex mutex_;
  std::optional<Progress> progress_;  // guarded by mutex_
  bool progress_is_new_ = false;      // guarded by mutex_
  std::string kept_result_;           // guarded by mutex_
};

}  // namespace mortise::operations
