#include "common/operations/operation_run.h"

#include <utility>

#include "common/base/errors.h"

namespace mortise::operations {

OperationRun::OperationRun(const RunLease& lease, const Operation& operation,
                           std::string checkpoint, store::Store* store, OperationRecords* records)
    : lease_(lease),
      operation_(operation),
      checkpoint_(std::move(checkpoint)),
      store_(store),
      records_(records) {
  if (operation.cancel_requested) Cancel();
}

void OperationRun::Interrupt() {
  interrupted_ = true;  // before the handler can know, and return
  stop_.request_stop();
}

void OperationRun::LoseLease() {
  lost_ = true;
  Interrupt();
}

void OperationRun::ReportProgress(const Progress& progress) {
  std::lock_guard lock(mutex_);
  progress_ = progress;
  progress_is_new_ = true;
}

std::optional<Progress> OperationRun::TakeProgress() {
  std::lock_guard lock(mutex_);
  if (!std::exchange(progress_is_new_, false)) return std::nullopt;
  return progress_;
}

std::optional<Progress> OperationRun::last_progress() {
  std::lock_guard lock(mutex_);
  return progress_;
}

void OperationRun::KeepResult(std::string_view result) {
  std::lock_guard lock(mutex_);
  kept_result_ = result;
}

std::string OperationRun::kept_result() {
  std::lock_guard lock(mutex_);
  return kept_result_;
}

absl::Status OperationRun::TransactAsOwner(
    const std::function<absl::Status(store::Transaction&)>& change) {
  return store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(
        transaction.RenewLease(lease_.queue, lease_.id, lease_.attempt, lease_.duration));
    return change(transaction);
  });
}

absl::Status OperationRun::Transact(
    const std::function<absl::Status(store::Transaction&)>& change) {
  return TransactAsOwner(change);
}

absl::Status OperationRun::SaveCheckpoint(std::string_view bytes) {
  return TransactAsOwner([&](store::Transaction& transaction) {
    return records_->SaveCheckpoint(transaction, lease_.id, bytes);
  });
}

absl::Status OperationRun::TransactWithCheckpoint(
    const std::function<absl::Status(store::Transaction&)>& change, std::string_view checkpoint) {
  return TransactAsOwner([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(change(transaction));
    return records_->SaveCheckpoint(transaction, lease_.id, checkpoint);
  });
}

}  // namespace mortise::operations
