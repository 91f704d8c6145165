#include "services/simulator/service/task_methods.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/resources/page_rule.h"
#include "common/rpc/message_check.h"
#include "common/rpc/status_mapping.h"
#include "services/simulator/service/design_fields_checks.h"
#include "services/simulator/service/evaluation_subject.h"
#include "services/simulator/service/evaluator_records.h"
#include "services/simulator/service/file_upkeep.h"
#include "services/simulator/service/simulator_core.h"
#include "services/simulator/service/task_codec.h"
#include "services/simulator/service/task_progress.h"

namespace mortise::simulator::methods {
namespace {

constexpr std::size_t kMaxTaskKeyLength = 128;
constexpr int kMaxRenewals = 1000;  // leases in one call
constexpr int kListedAtOnce = 100;  // tasks read from the store at a time; some are large

// `seconds`, or `otherwise` for 0; INVALID_ARGUMENT naming `field` outside the range.
absl::StatusOr<absl::Duration> Seconds(double seconds, double otherwise, double minimum,
                                       double maximum, const char* field) {
  if (seconds == 0) seconds = otherwise;
  if (seconds >= minimum && seconds <= maximum) return absl::Seconds(seconds);
  return InvalidField(field, absl::StrCat("must be within ", minimum, " to ", maximum));
}

// The queue named by a request, ours if none is.
absl::StatusOr<std::string> QueueName(const std::string& evaluator) {
  if (evaluator.empty() || evaluator == kSimulatorQueue) return std::string(kSimulatorQueue);
  if (IsEvaluatorName(evaluator)) return evaluator;
  return InvalidField("evaluator", "must be simulator or have the form evaluators/{id}");
}

// The same; NOT_FOUND for an evaluator that is not registered.
absl::StatusOr<std::string> KnownQueueName(store::Store& store, const std::string& evaluator) {
  MORTISE_ASSIGN_OR_RETURN(std::string queue, QueueName(evaluator));
  if (queue == kSimulatorQueue) return queue;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& read) {
    return kEvaluators.Get(read, queue, "evaluator").status();
  }));
  return queue;
}

// Digests, with an evaluator's id and a dot before them or not, and operations' identifiers with a
// prefix.
bool IsTaskKey(const std::string& key) {
  return !key.empty() && key.size() <= kMaxTaskKeyLength &&
         std::all_of(key.begin(), key.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
         });
}

absl::StatusOr<std::string> TaskKey(const std::string& name, const std::string& field) {
  if (absl::StartsWith(name, "tasks/") && IsTaskKey(name.substr(6))) return name.substr(6);
  return InvalidField(field, "must have the form tasks/{id}");
}

absl::Status CheckAttempt(int attempt, const std::string& field) {
  if (attempt >= 1) return absl::OkStatus();
  return InvalidField(field, "must be at least 1, as leased");
}

// What becomes of a task whose result has the fault.
absl::Status FailureFrom(const v1::EvaluationResult& result, const absl::Status& fault) {
  const std::string field = DetailOf(fault).field;
  const std::string what = WhatIsNotFinite(result);
  if (!what.empty()) {
    return PreconditionFailed("NOT_FINITE", absl::StrCat("not a finite number: ", what), field);
  }
  return PreconditionFailed(
      "RESULT_UNUSABLE", absl::StrCat("what the worker reports cannot be used: ", fault.message()),
      field);
}

absl::StatusOr<v1::ListTasksResponse::TaskAndError> EntryOf(const store::Task& task) {
  v1::ListTasksResponse::TaskAndError entry;
  MORTISE_ASSIGN_OR_RETURN(*entry.mutable_task(), ToProto(task));
  if (const absl::Status error = TaskError(task); IsFinished(task) && !error.ok()) {
    *entry.mutable_error() = rpc::ToProto(error);
  }
  return entry;
}

// A damaged task is left out: its lease runs out until it has had all of its attempts.
v1::LeaseTasksResponse ToLease(const std::vector<store::Task>& tasks) {
  v1::LeaseTasksResponse response;
  for (const store::Task& task : tasks) {
    absl::StatusOr<v1::Task> message = ToProto(task);
    if (message.ok()) {
      *response.add_tasks() = *std::move(message);
    } else {
      Log(LogLevel::kError, "task cannot be read", {{"error", message.status().message()}});
    }
  }
  return response;
}

// What a worker says of its attempt, on the way into the store.
class Report {
 public:
  Report(const v1::ReportTaskRequest& asked, std::string key, store::Store& store,
         store::BlobFolder& blobs, LeasedTaskCache& leased_tasks)
      : asked_(asked),
        key_(std::move(key)),
        queue_(QueueOf(key_)),
        blobs_(blobs),
        leased_tasks_(leased_tasks) {
    // Before any transaction, as it may take a while.
    if (!asked.result().has_design_fields()) return;
    const absl::StatusOr<bool> wants = WantsFile(store);
    if (!wants.ok()) {
      file_ = wants.status();
    } else if (*wants) {
      file_ = ReadReported(blobs_, asked.result().design_fields().sha256());
    }
  }

  // Becomes the task's end, or its next try; the task as it is then. What cannot be used, numbers
  // that are not finite say, ends the task too: sent again it would be no better, and whoever waits
  // should hear of it.
  absl::StatusOr<store::Task> Settle(store::Transaction& transaction) {
    v1::ReportTaskRequest report = asked_;
    MORTISE_RETURN_IF_ERROR(FindFault(transaction, report));
    if (fault_.ok() && !report.result().has_error()) {
      return transaction.CompleteTask(queue_, key_, asked_.task().attempt(),
                                      report.SerializeAsString());
    }
    MORTISE_RETURN_IF_ERROR(SettleFailure(transaction));
    return transaction.GetTask(queue_, key_);
  }

  // Why it could not be used; OK if it could.
  const absl::Status& fault() const { return fault_; }

 private:
  // Whether this attempt at an evaluator's task is to give a file. Others' files are not opened,
  // which takes memory and time; the transaction says what is wrong with such a report.
  absl::StatusOr<bool> WantsFile(store::Store& store) const {
    if (!IsEvaluatorName(queue_)) return false;
    if (const auto leased = leased_tasks_.Find(key_)) return leased->task.has_design_fields();
    bool wants = false;
    const absl::Status read = store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(const store::Task stored, transaction.GetTask(queue_, key_));
      v1::Task task;
      wants = stored.attempt == asked_.task().attempt() && task.ParseFromString(stored.payload) &&
              task.has_design_fields();
      return absl::OkStatus();
    });
    if (!read.ok() && !absl::IsNotFound(read)) return read;
    return wants;
  }

  absl::Status SettleFailure(store::Transaction& transaction) const {
    const int64_t attempt = asked_.task().attempt();
    if (!fault_.ok()) {
      const absl::Status failure = FailureFrom(asked_.result(), fault_);
      return transaction.FailTask(queue_, key_, attempt, EncodeError(failure), false);
    }
    const absl::Status failure = rpc::FromProto(asked_.result().error());
    // A worker that ends gives its work back unharmed.
    if (absl::IsCancelled(failure)) return transaction.ReleaseTask(queue_, key_, attempt);
    return transaction.FailTask(queue_, key_, attempt, EncodeError(failure), IsTransient(failure),
                                absl::Seconds(1));
  }

  // Sets fault_, and fills in what the report may leave out. Fails only if the store does, or has
  // no such task.
  absl::Status FindFault(store::ReadTransaction& transaction, v1::ReportTaskRequest& report) {
    fault_ = absl::OkStatus();
    if (report.result().has_error()) {
      if (rpc::FromProto(report.result().error()).ok()) {
        fault_ = InvalidField("result.error", "must have a code other than OK");
      }
      return absl::OkStatus();
    }
    fault_ = rpc::CheckMessage(report);
    if (!fault_.ok()) return absl::OkStatus();
    for (int i = 0; i < report.analysis().artifacts_size(); ++i) {
      if (blobs_.Size(report.analysis().artifacts(i).sha256()).ok()) continue;
      fault_ =
          InvalidField(absl::StrCat("analysis.artifacts[", i, "].sha256"), "has not been uploaded");
      return absl::OkStatus();
    }
    if (!IsEvaluatorName(queue_)) {
      fault_ = CheckUploaded(report.result());
      return absl::OkStatus();
    }
    if (const auto leased = leased_tasks_.Find(key_)) {
      return Complete(leased->task, leased->evaluator->space(), report);
    }
    // Another replica leased it, or this one did before it was started again.
    MORTISE_ASSIGN_OR_RETURN(const store::Task stored, transaction.GetTask(queue_, key_));
    v1::Task task;
    if (!task.ParseFromString(stored.payload)) {
      return StorageFailed(absl::StrCat("tasks/", key_), "the task cannot be read");
    }
    MORTISE_ASSIGN_OR_RETURN(const v1::Evaluator evaluator,
                             kEvaluators.Get(transaction, queue_, "task.name"));
    return Complete(task, evaluator.space(), report);
  }

  // Our own workers say themselves what is in their file.
  absl::Status CheckUploaded(const v1::EvaluationResult& result) {
    if (!result.has_design_fields()) return absl::OkStatus();
    if (KeepYoung(blobs_, result.design_fields().sha256()).ok()) return absl::OkStatus();
    return InvalidField("result.design_fields.sha256", "has not been uploaded");
  }

  // Sets fault_; fails only if the file cannot be read for a reason of the disk's.
  absl::Status Complete(const v1::Task& task, const v1::DesignSpace& space,
                        v1::ReportTaskRequest& report) {
    fault_ = CompleteResult(task, space, *report.mutable_result());
    if (!fault_.ok()) return absl::OkStatus();
    const absl::Status completed =
        CompleteDesignFields(task, space, file_, *report.mutable_result());
    if (!completed.ok() && !absl::IsInvalidArgument(completed)) return completed;
    fault_ = completed;
    return absl::OkStatus();
  }

  const v1::ReportTaskRequest& asked_;
  const std::string key_;
  const std::string queue_;
  store::BlobFolder& blobs_;
  LeasedTaskCache& leased_tasks_;
  // Of a result that names one.
  absl::StatusOr<ReportedFile> file_ =
      InvalidField("result.design_fields", "is not of an attempt that there is");
  absl::Status fault_;
};

}  // namespace

absl::Status LeaseTasks(const Simulator& simulator, const rpc::Call& call,
                        const v1::LeaseTasksRequest& asked,
                        rpc::Responder<v1::LeaseTasksResponse> respond) {
  MORTISE_ASSIGN_OR_RETURN(const std::string queue, QueueName(asked.evaluator()));
  if (asked.worker().empty()) return InvalidField("worker", "must name the worker");
  if (asked.limit() < 1 || asked.limit() > 16) {
    return InvalidField("limit", "must be within 1 to 16");
  }
  MORTISE_ASSIGN_OR_RETURN(const absl::Duration lease,
                           Seconds(asked.lease_seconds(), 30, 1, 3600, "lease_seconds"));
  MORTISE_ASSIGN_OR_RETURN(const absl::Duration wait,
                           Seconds(asked.wait_seconds(), 0, 0, 60, "wait_seconds"));
  SimulatorCore& core = *simulator.core;
  const auto take = [&core, queue, worker = asked.worker(), limit = asked.limit(),
                     lease](bool others_wait) -> absl::StatusOr<v1::LeaseTasksResponse> {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Task> tasks,
                             core.Lease(queue, worker, others_wait ? 1 : limit, lease));
    return ToLease(tasks);
  };
  rpc::RespondWhenWork<v1::LeaseTasksResponse>(
      core.idle_workers(), queue, wait, call, std::move(respond), take,
      [](const v1::LeaseTasksResponse& response) { return response.tasks().empty(); });
  return absl::OkStatus();
}

absl::StatusOr<v1::RenewLeasesResponse> RenewLeases(const Simulator& simulator, const rpc::Call&,
                                                    const v1::RenewLeasesRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const absl::Duration lease,
                           Seconds(asked.lease_seconds(), 30, 1, 3600, "lease_seconds"));
  if (asked.tasks_size() > kMaxRenewals) {
    return InvalidField("tasks", absl::StrCat("has more than ", kMaxRenewals, " entries"));
  }
  // All are looked at before any is prolonged.
  std::vector<std::string> keys;
  for (int i = 0; i < asked.tasks_size(); ++i) {
    const v1::TaskAttempt& attempt = asked.tasks(i);
    const std::string field = absl::StrCat("tasks[", i, "]");
    MORTISE_ASSIGN_OR_RETURN(keys.emplace_back(), TaskKey(attempt.name(), field + ".name"));
    MORTISE_RETURN_IF_ERROR(CheckAttempt(attempt.attempt(), field + ".attempt"));
    if (!attempt.has_progress()) continue;
    MORTISE_RETURN_IF_ERROR(CheckProgress(attempt.progress(), field + ".progress"));
  }
  v1::RenewLeasesResponse response;
  for (int i = 0; i < asked.tasks_size(); ++i) {
    const v1::TaskAttempt& attempt = asked.tasks(i);
    const absl::Status status = simulator.core->store()->Transact(
        [&](store::Transaction& transaction) -> absl::Status {
          MORTISE_RETURN_IF_ERROR(
              transaction.RenewLease(QueueOf(keys[i]), keys[i], attempt.attempt(), lease));
          if (!attempt.has_progress()) return absl::OkStatus();
          return KeepProgress(transaction, keys[i], attempt);
        },
        store::Isolation::kReadCommitted);
    if (absl::IsAborted(status) || absl::IsFailedPrecondition(status) || absl::IsNotFound(status)) {
      response.add_lost(attempt.name());
    } else if (!status.ok()) {
      return status;
    }
  }
  return response;
}

absl::StatusOr<v1::ReportTaskResponse> ReportTask(const Simulator& simulator, const rpc::Call&,
                                                  const v1::ReportTaskRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::string key, TaskKey(asked.task().name(), "task.name"));
  MORTISE_RETURN_IF_ERROR(CheckAttempt(asked.task().attempt(), "task.attempt"));
  SimulatorCore& core = *simulator.core;
  Report report(asked, key, *core.store(), *simulator.blobs, core.leased_tasks());
  store::Task task;
  MORTISE_RETURN_IF_ERROR(core.store()->Transact(
      [&](store::Transaction& transaction) -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(task, report.Settle(transaction));
        return absl::OkStatus();
      },
      // What else it reads, the evaluator's metrics, cannot change.
      store::Isolation::kReadCommitted));
  if (IsFinished(task)) {
    core.waiters().Notify(task, false);
  } else {
    core.WakeWorkers();
  }
  MORTISE_RETURN_IF_ERROR(report.fault());
  return v1::ReportTaskResponse();
}

absl::Status RefuseReport(const Simulator& simulator, const rpc::Call& call,
                          const v1::ReportTaskRequest& asked) {
  return ReportTask(simulator, call, asked).status();
}

absl::StatusOr<v1::QueueStatus> GetQueueStatus(const Simulator& simulator, const rpc::Call&,
                                               const v1::GetQueueStatusRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::string queue,
                           KnownQueueName(*simulator.core->store(), asked.evaluator()));
  store::QueueDepth depth;
  MORTISE_RETURN_IF_ERROR(
      simulator.core->store()->Read([&](store::ReadTransaction& read) -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(depth, read.Depth(queue));
        return absl::OkStatus();
      }));
  v1::QueueStatus status;
  status.set_queued(depth.queued);
  status.set_leased(depth.leased);
  status.set_done(depth.succeeded + depth.failed);
  status.set_quarantined(depth.quarantined);
  return status;
}

absl::StatusOr<v1::ListTasksResponse> ListTasks(const Simulator& simulator, const rpc::Call&,
                                                const v1::ListTasksRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::string queue,
                           KnownQueueName(*simulator.core->store(), asked.evaluator()));
  MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
  v1::ListTasksResponse response;
  MORTISE_RETURN_IF_ERROR(
      simulator.core->store()->Read([&](store::ReadTransaction& read) -> absl::Status {
        response.Clear();
        resources::PageRoom room(query.size);
        std::string after = query.after;
        std::string last;
        // The store lists by key; states are picked out here, some tasks at a time.
        while (true) {
          MORTISE_ASSIGN_OR_RETURN(
              const auto tasks,
              read.ListTasks(queue, {.after_key = after, .limit = kListedAtOnce}));
          for (const store::Task& task : tasks) {
            MORTISE_ASSIGN_OR_RETURN(v1::ListTasksResponse::TaskAndError entry, EntryOf(task));
            const bool is_wanted = asked.state() == v1::TASK_STATE_UNSPECIFIED ||
                                   entry.task().state() == asked.state();
            if (!is_wanted) continue;
            if (!room.Take(entry.ByteSizeLong())) {
              response.set_next_page_token(last);
              return absl::OkStatus();
            }
            last = task.key;
            *response.add_tasks() = std::move(entry);
          }
          if (static_cast<int>(tasks.size()) < kListedAtOnce) return absl::OkStatus();
          after = tasks.back().key;
        }
      }));
  return response;
}

}  // namespace mortise::simulator::methods
