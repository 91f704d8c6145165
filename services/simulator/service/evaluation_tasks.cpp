#include "services/simulator/service/evaluation_tasks.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/surface/assembly_surface.h"
#include "common/host/file_quota.h"
#include "common/rpc/status_mapping.h"
#include "google/rpc/status.pb.h"
#include "services/simulator/airflow/openfoam.h"
#include "services/simulator/worker/task_evaluation.h"

namespace mortise::simulator {

std::string TaskKeyIn(const std::string& queue, const std::string& digest) {
  if (queue == kSimulatorQueue) return digest;
  return absl::StrCat(queue.substr(queue.find('/') + 1), ".", digest);
}

std::string QueueOf(const std::string& key) {
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos) return kSimulatorQueue;
  return absl::StrCat("evaluators/", key.substr(0, dot));
}

bool IsFinished(const store::Task& task) {
  return task.state != store::TaskState::kQueued && task.state != store::TaskState::kLeased;
}

bool IsTransient(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kDeadlineExceeded:
    case absl::StatusCode::kUnauthenticated:
      return true;
    default:
      return false;
  }
}

namespace {

// A worker's limit of time is not the task's, nor is what is installed beside it, nor the quota of
// files: the next may give it longer, have it, or have more room.
bool MayEndOtherwise(const absl::Status& failure) {
  const std::string reason = DetailOf(failure).reason;
  return IsTransient(failure) || reason == kTimeLimit || reason == kNoOpenFoam ||
         reason == cad::kNoGmsh || reason == rpc::kFileBeyondQuota;
}

// A task that is there, queued afresh if it is worth it.
absl::StatusOr<FoundTask> FindOrRenew(store::Transaction& transaction, const store::NewTask& fresh,
                                      const IsWhole& is_whole) {
  MORTISE_ASSIGN_OR_RETURN(store::Task task, transaction.GetTask(fresh.queue, fresh.key));
  const bool again =
      task.state == store::TaskState::kCancelled ||
      (task.state == store::TaskState::kFailed && MayEndOtherwise(TaskError(task))) ||
      (task.state == store::TaskState::kSucceeded && !is_whole(task));
  if (again) {
    MORTISE_RETURN_IF_ERROR(transaction.DeleteTask(fresh.queue, fresh.key));
    MORTISE_RETURN_IF_ERROR(transaction.EnqueueTask(fresh));
    return FoundTask();
  }
  if (!IsFinished(task)) return FoundTask();
  const bool has_result = task.state == store::TaskState::kSucceeded;
  return FoundTask{.finished = std::move(task), .known_before = has_result};
}

}  // namespace

absl::StatusOr<std::vector<FoundTask>> FindOrEnqueue(store::Transaction& transaction,
                                                     const std::vector<WantedTask>& wanted,
                                                     const IsWhole& is_whole) {
  std::vector<store::NewTask> fresh;
  for (const WantedTask& task : wanted) {
    fresh.push_back({.queue = QueueOf(task.key),
                     .key = task.key,
                     .payload = task.payload,
                     .priority = task.priority});
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<bool> queued, transaction.EnqueueTasks(fresh));
  std::vector<FoundTask> found(wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (queued[i]) continue;
    MORTISE_ASSIGN_OR_RETURN(found[i], FindOrRenew(transaction, fresh[i], is_whole));
  }
  return found;
}

int64_t TaskWaiters::Add(const std::string& key, Callback callback) {
  const std::lock_guard lock(mutex_);
  const int64_t ticket = next_ticket_++;
  callbacks_[key][ticket] = std::move(callback);
  return ticket;
}

bool TaskWaiters::IsAwaited(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  return callbacks_.contains(key);
}

bool TaskWaiters::Remove(const std::string& key, int64_t ticket) {
  const std::lock_guard lock(mutex_);
  const auto found = callbacks_.find(key);
  if (found == callbacks_.end() || found->second.erase(ticket) == 0) return false;
  if (!found->second.empty()) return false;
  callbacks_.erase(found);
  return true;
}

void TaskWaiters::Notify(const store::Task& task, bool known_before) {
  std::map<int64_t, Callback> callbacks;
  {
    const std::lock_guard lock(mutex_);
    const auto found = callbacks_.find(task.key);
    if (found == callbacks_.end()) return;
    callbacks = std::move(found->second);
    callbacks_.erase(found);
  }
  for (const auto& [ticket, callback] : callbacks) callback(task, known_before);
}

std::vector<std::string> TaskWaiters::Keys() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> keys;
  for (const auto& [key, callbacks] : callbacks_) keys.push_back(key);
  return keys;
}

std::string EncodeError(const absl::Status& status) {
  return rpc::ToProto(status).SerializeAsString();
}

absl::Status DecodeError(const std::string& bytes) {
  google::rpc::Status message;
  if (!message.ParseFromString(bytes) || message.code() == 0) {
    return absl::InternalError(absl::StrCat("the task failed: ", bytes));
  }
  return rpc::FromProto(message);
}

absl::Status TaskError(const store::Task& task) {
  switch (task.state) {
    case store::TaskState::kSucceeded:
      return absl::OkStatus();
    case store::TaskState::kFailed:
      return DecodeError(task.error);
    case store::TaskState::kQuarantined:
      return PreconditionFailed(
          "QUARANTINED",
          absl::StrCat("the evaluation ended ", task.attempt,
                       " workers without a report and was put aside as tasks/", task.key),
          absl::StrCat("tasks/", task.key));
    case store::TaskState::kCancelled:
      return absl::CancelledError("nobody wanted the evaluation any more");
    default:
      return absl::InternalError("the task has not finished");
  }
}

}  // namespace mortise::simulator
