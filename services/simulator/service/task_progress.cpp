#include "services/simulator/service/task_progress.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/simulator/service/evaluation_tasks.h"

namespace mortise::simulator {
namespace {

constexpr char kProgressKind[] = "task-progress";  // records of v1.TaskAttempt, by the task's key
constexpr std::size_t kMaxStageLength = 200;
constexpr int kMaxSteps = 1'000'000;
constexpr int kPage = 100;

// What was told last, of whichever attempt; empty if nothing.
absl::StatusOr<v1::TaskAttempt> LastTold(store::ReadTransaction& transaction,
                                         const std::string& key) {
  v1::TaskAttempt told;
  const absl::StatusOr<store::Record> record = transaction.Get(kProgressKind, key);
  if (absl::IsNotFound(record.status())) return told;
  MORTISE_RETURN_IF_ERROR(record.status());
  if (told.ParseFromString(record->payload)) return told;
  return StorageFailed(absl::StrCat("tasks/", key), "its progress cannot be read");
}

}  // namespace

absl::Status CheckProgress(const v1::TaskProgress& progress, const std::string& field) {
  if (progress.stage().size() > kMaxStageLength) {
    return InvalidField(field + ".stage",
                        absl::StrCat("is longer than ", kMaxStageLength, " bytes"));
  }
  if (progress.total() < 1 || progress.total() > kMaxSteps) {
    return InvalidField(field + ".total", absl::StrCat("must be within 1 to ", kMaxSteps));
  }
  if (progress.done() < 0 || progress.done() > progress.total()) {
    return InvalidField(field + ".done", "must be within 0 to total");
  }
  return absl::OkStatus();
}

absl::Status KeepProgress(store::Transaction& transaction, const std::string& key,
                          const v1::TaskAttempt& told) {
  MORTISE_ASSIGN_OR_RETURN(const v1::TaskAttempt last, LastTold(transaction, key));
  if (last.attempt() == told.attempt()) {
    const v1::TaskProgress& before = last.progress();
    if (told.progress().done() < before.done()) return absl::OkStatus();
    if (told.progress().SerializeAsString() == before.SerializeAsString()) return absl::OkStatus();
  }
  return transaction.Put(kProgressKind, key, told.SerializeAsString()).status();
}

absl::StatusOr<std::optional<v1::TaskProgress>> FindProgress(store::ReadTransaction& transaction,
                                                             const store::Task& task,
                                                             absl::Time now) {
  if (task.state != store::TaskState::kLeased || task.lease_expires_at <= now) return std::nullopt;
  MORTISE_ASSIGN_OR_RETURN(const v1::TaskAttempt told, LastTold(transaction, task.key));
  if (told.attempt() != task.attempt) return std::nullopt;
  return told.progress();
}

absl::StatusOr<std::vector<std::string>> FindOldProgress(store::ReadTransaction& transaction) {
  std::vector<std::string> old;
  store::ListOptions list{.limit = kPage};
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const auto page, transaction.List(kProgressKind, list));
    for (const store::Record& record : page) {
      const absl::StatusOr<store::Task> task = transaction.GetTask(QueueOf(record.key), record.key);
      if (!task.ok() && !absl::IsNotFound(task.status())) return task.status();
      if (!task.ok() || IsFinished(*task)) old.push_back(record.key);
    }
    if (static_cast<int>(page.size()) < kPage) return old;
    list.after_key = page.back().key;
  }
}

absl::Status ForgetProgress(store::Transaction& transaction, const std::string& key) {
  const absl::Status removed = transaction.Delete(kProgressKind, key);
  return absl::IsNotFound(removed) ? absl::OkStatus() : removed;
}

}  // namespace mortise::simulator
