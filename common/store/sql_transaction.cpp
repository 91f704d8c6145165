#include "common/store/sql_transaction.h"

namespace mortise::store {

absl::StatusOr<Record> SqlTransaction::Get(std::string_view kind, std::string_view key) {
  return records_.Get(kind, key);
}

absl::StatusOr<Record> SqlTransaction::GetRevision(std::string_view kind, std::string_view key,
                                                   int64_t revision) {
  return records_.GetRevision(kind, key, revision);
}

absl::StatusOr<std::vector<Record>> SqlTransaction::List(std::string_view kind,
                                                         const ListOptions& options) {
  return records_.List(kind, options);
}

absl::StatusOr<std::vector<NumberedEvent>> SqlTransaction::ReadEvents(int64_t after_number,
                                                                      int limit) {
  return events_.Read(after_number, limit);
}

absl::StatusOr<int64_t> SqlTransaction::LatestEventNumber() { return events_.LatestNumber(); }

absl::StatusOr<int64_t> SqlTransaction::Epoch() { return events_.Epoch(); }

absl::StatusOr<Task> SqlTransaction::GetTask(std::string_view queue, std::string_view key) {
  return tasks_.Get(queue, key);
}

absl::StatusOr<std::vector<Task>> SqlTransaction::ListTasks(std::string_view queue,
                                                            const ListOptions& options) {
  return tasks_.List(queue, options);
}

absl::StatusOr<QueueDepth> SqlTransaction::Depth(std::string_view queue) {
  return tasks_.Depth(queue);
}

absl::StatusOr<int64_t> SqlTransaction::Put(std::string_view kind, std::string_view key,
                                            std::string_view payload, const PutOptions& options) {
  return records_.Put(kind, key, payload, options, now_);
}

absl::Status SqlTransaction::Delete(std::string_view kind, std::string_view key,
                                    std::optional<int64_t> expected_revision) {
  return records_.Delete(kind, key, expected_revision);
}

absl::Status SqlTransaction::AppendEvent(const NewEvent& event) {
  wakes_listeners_ = true;
  return events_.Append(event, now_);
}

absl::Status SqlTransaction::EnqueueTask(const NewTask& task) {
  wakes_listeners_ = true;
  return tasks_.Enqueue(task);
}

absl::StatusOr<std::vector<bool>> SqlTransaction::EnqueueTasks(const std::vector<NewTask>& tasks) {
  wakes_listeners_ = true;
  return tasks_.EnqueueAll(tasks);
}

absl::StatusOr<LeaseResult> SqlTransaction::LeaseTasks(std::string_view queue,
                                                       std::string_view worker, int limit,
                                                       absl::Duration lease) {
  return tasks_.Lease(queue, worker, limit, lease);
}

absl::Status SqlTransaction::RenewLease(std::string_view queue, std::string_view key,
                                        int64_t attempt, absl::Duration lease) {
  return tasks_.Renew(queue, key, attempt, lease);
}

absl::StatusOr<Task> SqlTransaction::CompleteTask(std::string_view queue, std::string_view key,
                                                  int64_t attempt, std::string_view result) {
  return tasks_.Complete(queue, key, attempt, result);
}

absl::Status SqlTransaction::FailTask(std::string_view queue, std::string_view key, int64_t attempt,
                                      std::string_view error, bool retry, absl::Duration delay) {
  wakes_listeners_ = true;
  return tasks_.Fail(queue, key, attempt, error, retry, delay);
}

absl::Status SqlTransaction::ReleaseTask(std::string_view queue, std::string_view key,
                                         int64_t attempt) {
  wakes_listeners_ = true;
  return tasks_.Release(queue, key, attempt);
}

absl::StatusOr<int64_t> SqlTransaction::ExpireLeases(std::string_view queue,
                                                     std::string_view worker) {
  wakes_listeners_ = true;
  return tasks_.ExpireLeases(queue, worker);
}

absl::Status SqlTransaction::CancelTask(std::string_view queue, std::string_view key) {
  return tasks_.Cancel(queue, key);
}

absl::Status SqlTransaction::DeleteTask(std::string_view queue, std::string_view key) {
  return tasks_.Delete(queue, key);
}

void SqlTransaction::AfterCommit(std::function<void()> callback) {
  callbacks_.push_back(std::move(callback));
}

}  // namespace mortise::store
