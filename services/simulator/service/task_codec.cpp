#include "services/simulator/service/task_codec.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

v1::TaskState ToProto(store::TaskState state) {
  switch (state) {
    case store::TaskState::kQueued:
      return v1::QUEUED;
    case store::TaskState::kLeased:
      return v1::LEASED;
    case store::TaskState::kSucceeded:
      return v1::DONE;
    case store::TaskState::kFailed:
      return v1::TASK_FAILED;
    case store::TaskState::kQuarantined:
      return v1::QUARANTINED;
    case store::TaskState::kCancelled:
      return v1::TASK_CANCELLED;
  }
  return v1::TASK_STATE_UNSPECIFIED;
}

}  // namespace

absl::StatusOr<v1::Task> ToProto(const store::Task& task) {
  v1::Task message;
  if (!message.ParseFromString(task.payload)) {
    return StorageFailed(absl::StrCat("tasks/", task.key), "the record cannot be read");
  }
  message.set_name(absl::StrCat("tasks/", task.key));
  message.set_evaluator(task.queue);
  message.set_attempt(static_cast<int>(task.attempt));
  message.set_state(ToProto(task.state));
  message.set_worker(task.worker);
  if (task.attempt > 0) {
    const int64_t microseconds = absl::ToUnixMicros(task.lease_expires_at);
    message.mutable_lease_expiry()->set_seconds(microseconds / 1000000);
    message.mutable_lease_expiry()->set_nanos(static_cast<int>(microseconds % 1000000) * 1000);
  }
  return message;
}

}  // namespace mortise::simulator
