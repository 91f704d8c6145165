#include "common/store/task_table.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/substitute.h"
#include "common/base/errors.h"
#include "common/store/limits.h"
#include "common/store/record_table.h"

// What a Task is read from, in the order of TaskOf.
#define TASK_COLUMNS                                                                       \
  "queue, key, payload, state, attempt, max_attempts, priority, worker, lease_expires_at," \
  " result, error, created_at, updated_at, arrival"

// 1 of a leased task that its worker has not begun, 0 of any other: a worker does what it holds in
// the order in which it was leased, and what it has done is no longer leased.
#define HELD_IN_RESERVE                                                                   \
  "(CASE WHEN EXISTS (SELECT 1 FROM tasks AS earlier WHERE earlier.queue = tasks.queue"   \
  " AND earlier.worker = tasks.worker AND earlier.state = 1"                              \
  " AND (earlier.updated_at < tasks.updated_at OR (earlier.updated_at = tasks.updated_at" \
  " AND (earlier.priority > tasks.priority OR (earlier.priority = tasks.priority"         \
  " AND earlier.arrival < tasks.arrival))))) THEN 1 ELSE 0 END)"

namespace mortise::store {
namespace {

// The states as SQL below spells them; part of the file format.
static_assert(static_cast<int>(TaskState::kQueued) == 0);
static_assert(static_cast<int>(TaskState::kLeased) == 1);
static_assert(static_cast<int>(TaskState::kSucceeded) == 2);
static_assert(static_cast<int>(TaskState::kFailed) == 3);
static_assert(static_cast<int>(TaskState::kCancelled) == 4);
static_assert(static_cast<int>(TaskState::kQuarantined) == 5);

constexpr std::size_t kArrival = 13;

std::string NameOf(std::string_view queue, std::string_view key) {
  return absl::StrCat(std::string(queue), "/", std::string(key));
}

absl::Status CheckTaskName(std::string_view queue, std::string_view key) {
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("queue", queue));
  return CheckRequiredName("key", key);
}

absl::Status CheckLease(absl::Duration lease) {
  if (lease <= absl::ZeroDuration() || lease > absl::Hours(24 * 365)) {
    return InvalidField("lease", "must be longer than nothing and at most a year");
  }
  return absl::OkStatus();
}

Task TaskOf(SqlRow& row) {
  return {.queue = std::move(row[0].text),
          .key = std::move(row[1].text),
          .payload = std::move(row[2].text),
          .state = static_cast<TaskState>(row[3].integer),
          .attempt = row[4].integer,
          .max_attempts = static_cast<int>(row[5].integer),
          .priority = static_cast<int>(row[6].integer),
          .worker = std::move(row[7].text),
          .lease_expires_at = absl::FromUnixMicros(row[8].integer),
          .result = std::move(row[9].text),
          .error = std::move(row[10].text),
          .created_at = absl::FromUnixMicros(row[11].integer),
          .updated_at = absl::FromUnixMicros(row[12].integer)};
}

// UPDATE … RETURNING gives rows in no order: puts them in the order of the queue.
std::vector<Task> TasksInOrder(std::vector<SqlRow>& rows) {
  std::sort(rows.begin(), rows.end(), [](const SqlRow& a, const SqlRow& b) {
    if (a[6].integer != b[6].integer) return a[6].integer > b[6].integer;
    return a[kArrival].integer < b[kArrival].integer;
  });
  std::vector<Task> tasks;
  tasks.reserve(rows.size());
  for (SqlRow& row : rows) tasks.push_back(TaskOf(row));
  return tasks;
}

absl::Status Finished(std::string_view queue, std::string_view key, TaskState state) {
  const std::string name = NameOf(queue, key);
  if (state == TaskState::kCancelled) {
    return PreconditionFailed("TASK_CANCELLED", absl::StrCat("'", name, "' was cancelled"), name);
  }
  return PreconditionFailed("TASK_FINISHED", absl::StrCat("'", name, "' is ", TaskStateName(state)),
                            name);
}

constexpr std::size_t kInsertedAtOnce = 16;

// Inserts so many tasks, of six values each.
std::string InsertionOf(std::size_t tasks) {
  std::string sql =
      "INSERT INTO tasks (queue, key, payload, state, attempt, counted_attempts, max_attempts,"
      " priority, due_at, worker, lease_expires_at, result, error, created_at, updated_at) VALUES";
  for (std::size_t i = 0; i < tasks; ++i) {
    absl::StrAppend(
        &sql, i == 0 ? "" : ",",
        absl::Substitute(" ($$$0, $$$1, $$$2, 0, 0, 0, $$$3, $$$4, $$$5, '', 0, '', "
                         "'', $$$5, $$$5)",
                         6 * i + 1, 6 * i + 2, 6 * i + 3, 6 * i + 4, 6 * i + 5, 6 * i + 6));
  }
  return sql + " ON CONFLICT (queue, key) DO NOTHING RETURNING queue, key";
}

}  // namespace

const char* TaskStateName(TaskState state) {
  switch (state) {
    case TaskState::kQueued:
      return "queued";
    case TaskState::kLeased:
      return "leased";
    case TaskState::kSucceeded:
      return "succeeded";
    case TaskState::kFailed:
      return "failed";
    case TaskState::kCancelled:
      return "cancelled";
    case TaskState::kQuarantined:
      return "quarantined";
  }
  return "unknown";
}

int64_t TaskTable::After(absl::Duration duration) const {
  return absl::ToUnixMicros(now_ + duration);
}

absl::StatusOr<Task> TaskTable::Get(std::string_view queue, std::string_view key) {
  MORTISE_RETURN_IF_ERROR(CheckTaskName(queue, key));
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("SELECT " TASK_COLUMNS " FROM tasks WHERE queue = $1 AND key = $2",
                       {queue, key}));
  if (result.rows.empty()) return ResourceNotFound(NameOf(queue, key));
  return TaskOf(result.rows[0]);
}

absl::StatusOr<std::vector<Task>> TaskTable::List(std::string_view queue,
                                                  const ListOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("queue", queue));
  MORTISE_RETURN_IF_ERROR(CheckName("after_key", options.after_key));
  MORTISE_RETURN_IF_ERROR(CheckName("key_prefix", options.key_prefix));
  MORTISE_RETURN_IF_ERROR(CheckLimit("limit", options.limit));
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("SELECT " TASK_COLUMNS " FROM tasks WHERE queue = $1 AND key > $2"
                       " AND key >= $3 AND key < $4 ORDER BY key LIMIT $5",
                       {queue, options.after_key, options.key_prefix,
                        EndOfPrefix(options.key_prefix), int64_t{options.limit}}));
  std::vector<Task> tasks;
  tasks.reserve(result.rows.size());
  for (SqlRow& row : result.rows) tasks.push_back(TaskOf(row));
  return tasks;
}

absl::StatusOr<QueueDepth> TaskTable::Depth(std::string_view queue) {
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("queue", queue));
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("SELECT state, COUNT(*) FROM tasks WHERE queue = $1 GROUP BY state",
                       {queue}));
  QueueDepth depth;
  int64_t* const counts[] = {&depth.queued, &depth.leased,    &depth.succeeded,
                             &depth.failed, &depth.cancelled, &depth.quarantined};
  for (const SqlRow& row : result.rows) {
    if (row[0].integer >= 0 && row[0].integer < 6) *counts[row[0].integer] = row[1].integer;
  }
  return depth;
}

absl::Status TaskTable::Enqueue(const NewTask& task) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<bool> queued, EnqueueAll({task}));
  return queued.front() ? absl::OkStatus() : ResourceExists(NameOf(task.queue, task.key));
}

absl::StatusOr<std::vector<bool>> TaskTable::EnqueueAll(const std::vector<NewTask>& tasks) {
  static const std::string one = InsertionOf(1), many = InsertionOf(kInsertedAtOnce);
  for (const NewTask& task : tasks) {
    MORTISE_RETURN_IF_ERROR(CheckTaskName(task.queue, task.key));
    MORTISE_RETURN_IF_ERROR(CheckPayload("payload", task.payload));
    if (task.max_attempts < 1) return InvalidField("max_attempts", "must be at least 1");
  }
  std::set<std::pair<std::string, std::string>> queued;
  for (std::size_t first = 0; first < tasks.size();) {
    const bool has_many = tasks.size() - first >= kInsertedAtOnce;
    const std::size_t end = first + (has_many ? kInsertedAtOnce : 1);
    std::vector<SqlValue> values;
    for (; first < end; ++first) {
      const NewTask& task = tasks[first];
      values.insert(values.end(), {std::string_view(task.queue), std::string_view(task.key),
                                   SqlBytes{task.payload}, int64_t{task.max_attempts},
                                   int64_t{task.priority}, absl::ToUnixMicros(now_)});
    }
    MORTISE_ASSIGN_OR_RETURN(SqlResult result,
                             connection_->Run((has_many ? many : one).c_str(), values));
    for (SqlRow& row : result.rows) {
      queued.emplace(std::move(row[0].text), std::move(row[1].text));
    }
  }
  std::vector<bool> is_queued;
  // Of those alike only the first was.
  for (const NewTask& task : tasks) is_queued.push_back(queued.erase({task.queue, task.key}) > 0);
  return is_queued;
}

absl::StatusOr<bool> TaskTable::HasExpired(std::string_view queue) {
  MORTISE_ASSIGN_OR_RETURN(
      const SqlResult result,
      connection_->Run("SELECT arrival FROM tasks WHERE queue = $1 AND state = 1"
                       " AND lease_expires_at <= $2 LIMIT 1",
                       {queue, absl::ToUnixMicros(now_)}));
  return !result.rows.empty();
}

absl::Status TaskTable::RequeueExpired(std::string_view queue) {
  return connection_
      ->Run("WITH expired AS MATERIALIZED (SELECT arrival, " HELD_IN_RESERVE
            " AS held_in_reserve FROM tasks WHERE queue = $1 AND state = 1"
            " AND lease_expires_at <= $2"
            " AND counted_attempts - " HELD_IN_RESERVE
            " < max_attempts FOR UPDATE SKIP LOCKED)"
            " UPDATE tasks SET state = 0, due_at = $2, updated_at = $2, counted_attempts ="
            " counted_attempts - (SELECT held_in_reserve FROM expired"
            " WHERE expired.arrival = tasks.arrival)"
            " WHERE arrival IN (SELECT arrival FROM expired)",
            {queue, absl::ToUnixMicros(now_)})
      .status();
}

absl::StatusOr<std::vector<Task>> TaskTable::QuarantineExpired(std::string_view queue) {
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run(
          "UPDATE tasks SET state = 5, worker = '', updated_at = $2, error = $3"
          " WHERE arrival IN (SELECT arrival FROM tasks WHERE queue = $1"
          " AND state = 1 AND lease_expires_at <= $2"
          " AND counted_attempts >= max_attempts FOR UPDATE SKIP LOCKED)"
          " RETURNING " TASK_COLUMNS,
          {queue, absl::ToUnixMicros(now_), SqlBytes{"its worker vanished in every attempt"}}));
  return TasksInOrder(result.rows);
}

absl::StatusOr<LeaseResult> TaskTable::Lease(std::string_view queue, std::string_view worker,
                                             int limit, absl::Duration lease) {
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("queue", queue));
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("worker", worker));
  MORTISE_RETURN_IF_ERROR(CheckLease(lease));
  if (limit != 0) MORTISE_RETURN_IF_ERROR(CheckLimit("limit", limit));
  LeaseResult answer;
  MORTISE_ASSIGN_OR_RETURN(const bool has_expired, HasExpired(queue));
  if (has_expired) {
    MORTISE_RETURN_IF_ERROR(RequeueExpired(queue));
    MORTISE_ASSIGN_OR_RETURN(answer.quarantined, QuarantineExpired(queue));
  }
  if (limit == 0) return answer;
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("WITH due AS MATERIALIZED (SELECT arrival FROM tasks WHERE queue = $1"
                       " AND state = 0 AND due_at <= $2 ORDER BY priority DESC, arrival LIMIT $3"
                       " FOR UPDATE SKIP LOCKED)"
                       " UPDATE tasks SET state = 1, attempt = attempt + 1,"
                       " counted_attempts = counted_attempts + 1, worker = $4,"
                       " lease_expires_at = $5, updated_at = $2"
                       " WHERE arrival IN (SELECT arrival FROM due) RETURNING " TASK_COLUMNS,
                       {queue, absl::ToUnixMicros(now_), int64_t{limit}, worker, After(lease)}));
  answer.leased = TasksInOrder(result.rows);
  return answer;
}

absl::StatusOr<TaskTable::Standing> TaskTable::LockStanding(std::string_view queue,
                                                            std::string_view key) {
  MORTISE_RETURN_IF_ERROR(CheckTaskName(queue, key));
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("SELECT state, attempt, counted_attempts, max_attempts, worker FROM tasks"
                       " WHERE queue = $1 AND key = $2 FOR UPDATE",
                       {queue, key}));
  if (result.rows.empty()) return ResourceNotFound(NameOf(queue, key));
  const SqlRow& row = result.rows[0];
  return Standing{.state = static_cast<TaskState>(row[0].integer),
                  .attempt = row[1].integer,
                  .counted_attempts = row[2].integer,
                  .max_attempts = row[3].integer,
                  .reportable = !row[4].text.empty()};
}

absl::Status TaskTable::CheckReportable(const Standing& standing, std::string_view queue,
                                        std::string_view key, int64_t attempt) {
  if (standing.state != TaskState::kQueued && standing.state != TaskState::kLeased) {
    return Finished(queue, key, standing.state);
  }
  if (standing.attempt != attempt || !standing.reportable) {
    return StaleAttempt(NameOf(queue, key), attempt, standing.attempt);
  }
  return absl::OkStatus();
}

absl::Status TaskTable::LockForReport(std::string_view queue, std::string_view key,
                                      int64_t attempt) {
  MORTISE_ASSIGN_OR_RETURN(const Standing standing, LockStanding(queue, key));
  return CheckReportable(standing, queue, key, attempt);
}

absl::Status TaskTable::Renew(std::string_view queue, std::string_view key, int64_t attempt,
                              absl::Duration lease) {
  MORTISE_RETURN_IF_ERROR(CheckLease(lease));
  MORTISE_RETURN_IF_ERROR(LockForReport(queue, key, attempt));
  return connection_
      ->Run("UPDATE tasks SET state = 1, lease_expires_at = $3 WHERE queue = $1 AND key = $2",
            {queue, key, After(lease)})
      .status();
}

absl::StatusOr<Task> TaskTable::Complete(std::string_view queue, std::string_view key,
                                         int64_t attempt, std::string_view result) {
  MORTISE_RETURN_IF_ERROR(CheckTaskName(queue, key));
  MORTISE_RETURN_IF_ERROR(CheckPayload("result", result));
  const auto record = [&] {
    return connection_->Run(
        "UPDATE tasks SET state = 2, result = $3, updated_at = $4 WHERE queue = $1 AND key = $2"
        " AND attempt = $5 AND state IN (0, 1) AND worker <> '' RETURNING " TASK_COLUMNS,
        {queue, key, SqlBytes{result}, absl::ToUnixMicros(now_), attempt});
  };
  // One statement is enough, unless the report comes in vain or again.
  MORTISE_ASSIGN_OR_RETURN(SqlResult recorded, record());
  if (recorded.rows.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const Standing standing, LockStanding(queue, key));
    if (standing.state == TaskState::kSucceeded) {
      if (standing.attempt == attempt) return Get(queue, key);
      return StaleAttempt(NameOf(queue, key), attempt, standing.attempt);
    }
    MORTISE_RETURN_IF_ERROR(CheckReportable(standing, queue, key, attempt));
    MORTISE_ASSIGN_OR_RETURN(recorded, record());  // it was changed between the two
    if (recorded.rows.empty()) return ResourceNotFound(NameOf(queue, key));
  }
  return TaskOf(recorded.rows[0]);
}

absl::Status TaskTable::Fail(std::string_view queue, std::string_view key, int64_t attempt,
                             std::string_view error, bool retry, absl::Duration delay) {
  MORTISE_RETURN_IF_ERROR(CheckPayload("error", error));
  if (delay < absl::ZeroDuration() || delay > absl::Hours(24 * 365)) {
    return InvalidField("delay", "must not be negative, and at most a year");
  }
  MORTISE_ASSIGN_OR_RETURN(const Standing standing, LockStanding(queue, key));
  const bool reported =
      standing.state == TaskState::kFailed ||
      (standing.state == TaskState::kQueued && !standing.reportable && standing.attempt > 0);
  if (reported && standing.attempt == attempt) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(CheckReportable(standing, queue, key, attempt));
  const bool again = retry && standing.counted_attempts < standing.max_attempts;
  return connection_
      ->Run(
          "UPDATE tasks SET state = $3, worker = '', error = $4, due_at = $5, updated_at = $6"
          " WHERE queue = $1 AND key = $2",
          {queue, key, static_cast<int64_t>(again ? TaskState::kQueued : TaskState::kFailed),
           SqlBytes{error}, After(delay), absl::ToUnixMicros(now_)})
      .status();
}

absl::Status TaskTable::Release(std::string_view queue, std::string_view key, int64_t attempt) {
  MORTISE_RETURN_IF_ERROR(LockForReport(queue, key, attempt));
  return connection_
      ->Run(
          "UPDATE tasks SET state = 0, worker = '', counted_attempts ="
          " CASE WHEN counted_attempts > 0 THEN counted_attempts - 1 ELSE 0 END,"
          " due_at = $3, updated_at = $3 WHERE queue = $1 AND key = $2",
          {queue, key, absl::ToUnixMicros(now_)})
      .status();
}

absl::StatusOr<int64_t> TaskTable::ExpireLeases(std::string_view queue, std::string_view worker) {
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("queue", queue));
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("worker", worker));
  MORTISE_ASSIGN_OR_RETURN(SqlResult result,
                           connection_->Run("UPDATE tasks SET lease_expires_at = $3"
                                            " WHERE queue = $1 AND worker = $2 AND state = 1",
                                            {queue, worker, absl::ToUnixMicros(now_)}));
  return result.changed;
}

absl::Status TaskTable::Cancel(std::string_view queue, std::string_view key) {
  MORTISE_ASSIGN_OR_RETURN(const Standing standing, LockStanding(queue, key));
  if (standing.state == TaskState::kCancelled) return absl::OkStatus();
  if (standing.state != TaskState::kQueued && standing.state != TaskState::kLeased) {
    return Finished(queue, key, standing.state);
  }
  return connection_
      ->Run(
          "UPDATE tasks SET state = 4, worker = '', updated_at = $3"
          " WHERE queue = $1 AND key = $2",
          {queue, key, absl::ToUnixMicros(now_)})
      .status();
}

absl::Status TaskTable::Delete(std::string_view queue, std::string_view key) {
  MORTISE_ASSIGN_OR_RETURN(const Standing standing, LockStanding(queue, key));
  if (standing.state == TaskState::kQueued || standing.state == TaskState::kLeased) {
    const std::string name = NameOf(queue, key);
    return PreconditionFailed(
        "TASK_UNFINISHED", absl::StrCat("'", name, "' is ", TaskStateName(standing.state)), name);
  }
  return connection_->Run("DELETE FROM tasks WHERE queue = $1 AND key = $2", {queue, key}).status();
}

}  // namespace mortise::store
