#include "services/simulator/service/analysis_operation.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/host/operation_codec.h"
#include "common/operations/bell.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/resources/resource_tags.h"
#include "common/store/store.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/service/analysis_records.h"
#include "services/simulator/service/simulator_core.h"
#include "services/simulator/service/task_progress.h"

namespace mortise::simulator {
namespace {

constexpr absl::Duration kLookForCancel = absl::Milliseconds(100);
constexpr absl::Duration kLookForProgress = absl::Milliseconds(500);
constexpr int kInteractivePriority = 10;  // a person waits for it; batches can wait

// The id at the end of "operations/simulator/{id}": the analysis takes it over, so that a resumed
// run makes the same one.
std::string IdOf(const std::string& operation) {
  return operation.substr(operation.rfind('/') + 1);
}

// What an analysis runs in.
struct Run {
  SimulatorCore& core;
  operations::Operations& operations;
  operations::OperationContext& context;
};

std::string KeyOf(const std::string& operation) {
  return absl::StrCat(kAnalysisTaskPrefix, IdOf(operation));
}

// The task of an analysis that is cancelled while nobody runs it.
absl::Status CancelTask(store::Transaction& transaction, const operations::Operation& operation) {
  const std::string key = KeyOf(operation.name);
  const absl::StatusOr<store::Task> task = transaction.GetTask(kSimulatorQueue, key);
  if (absl::IsNotFound(task.status())) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(task.status());
  if (IsFinished(*task)) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(transaction.CancelTask(kSimulatorQueue, key));
  return ForgetProgress(transaction, key);
}

// Whether somebody cancelled the analysis: where the process just ends, its task goes on, and the
// run that resumes finds it.
bool IsGivenUp(const Run& run) {
  const auto operation = run.operations.Get(run.context.name());
  return operation.ok() && operation->cancel_requested;
}

// What those who watch the analysis see of its worker.
class ProgressView {
 public:
  ProgressView(const Run& run, std::string key) : run_(run), key_(std::move(key)) {}

  // Looks at the task and tells what has changed.
  void Look() {
    operations::Progress seen = told_;
    const absl::Status status =
        run_.core.store()->Read([&](store::ReadTransaction& read) -> absl::Status {
          const absl::Time now = run_.core.store()->Now();
          MORTISE_ASSIGN_OR_RETURN(const store::Task task, read.GetTask(kSimulatorQueue, key_));
          MORTISE_ASSIGN_OR_RETURN(const auto of_worker, FindProgress(read, task, now));
          if (of_worker) {
            seen = {.done = of_worker->done(),
                    .total = of_worker->total(),
                    .message = of_worker->stage()};
          } else if (!IsFinished(task)) {
            const bool has_worker =
                task.state == store::TaskState::kLeased && task.lease_expires_at > now;
            seen = {.message = has_worker ? "with a worker" : "waiting for a worker"};
          }
          return absl::OkStatus();
        });
    if (status.ok()) Tell(seen);
  }

  void TellEnd() {
    const int64_t total = std::max<int64_t>(told_.total, 1);
    Tell({.done = total, .total = total, .message = "analysed"});
  }

 private:
  void Tell(const operations::Progress& progress) {
    if (progress.done == told_.done && progress.total == told_.total &&
        progress.message == told_.message) {
      return;
    }
    told_ = progress;
    run_.context.ReportProgress(progress);
  }

  const Run& run_;
  const std::string key_;
  operations::Progress told_;
};

// Queues the task, or finds it, and waits until it has finished.
absl::StatusOr<store::Task> AwaitTask(const Run& run, const std::string& key,
                                      const std::string& payload, ProgressView& progress) {
  SimulatorCore& core = run.core;
  struct Finished {
    operations::Bell bell;
    std::mutex mutex;
    std::optional<store::Task> task;
  };
  auto finished = std::make_shared<Finished>();
  const int64_t ticket = core.waiters().Add(key, [finished](const store::Task& task, bool) {
    {
      const std::lock_guard lock(finished->mutex);
      finished->task = task;
    }
    finished->bell.Ring();
  });
  const auto found =
      core.Enqueue({{.key = key, .payload = payload, .priority = kInteractivePriority}});
  if (!found.ok()) {
    core.waiters().Remove(key, ticket);
    return found.status();
  }
  const auto& [finished_before, known_before] = found->front();
  if (finished_before) core.waiters().Notify(*finished_before, known_before);
  absl::Time next_look = absl::InfinitePast();
  while (true) {
    {
      const std::lock_guard lock(finished->mutex);
      if (finished->task) return *finished->task;
    }
    if (run.context.Cancelled()) {
      if (core.waiters().Remove(key, ticket) && IsGivenUp(run)) core.CancelUnfinished(key);
      return absl::CancelledError("the analysis was cancelled");
    }
    if (absl::Now() >= next_look) {
      progress.Look();
      next_look = absl::Now() + kLookForProgress;
    }
    finished->bell.Wait(kLookForCancel);
  }
}

// The same, for a task that others share: whom they cancel it for is not this one.
absl::StatusOr<store::Task> RunTask(const Run& run, const std::string& key,
                                    const std::string& payload, ProgressView& progress) {
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(store::Task task, AwaitTask(run, key, payload, progress));
    if (task.state != store::TaskState::kCancelled) return task;
  }
}

// What the operation's worker reported, as the resource that the task was to make.
v1::Analysis AnalysisOf(const operations::Operation& operation, const v1::Task& task,
                        const v1::ReportTaskRequest& report) {
  v1::Analysis analysis = report.analysis();
  analysis.set_name(absl::StrCat("analyses/", IdOf(operation.name)));
  analysis.set_template_(task.subject());
  analysis.set_template_revision(task.revision());
  analysis.set_mesh_file(task.mesh_file());
  if (task.has_setup()) *analysis.mutable_setup() = task.setup();
  *analysis.mutable_metrics() = report.result().metrics();
  analysis.set_creator(operation.creator);
  resources::CopyTags(task, &analysis);
  return analysis;
}

absl::StatusOr<std::string> Analyse(const Run& run) {
  operations::OperationContext& context = run.context;
  v1::Task task;
  if (!task.ParseFromString(context.request())) {
    return absl::InternalError("the stored request cannot be read");
  }
  const std::string key = KeyOf(context.name());
  ProgressView progress(run, key);
  MORTISE_ASSIGN_OR_RETURN(const store::Task finished,
                           RunTask(run, key, task.SerializeAsString(), progress));
  MORTISE_RETURN_IF_ERROR(run.core.store()->Transact(
      [&](store::Transaction& transaction) { return ForgetProgress(transaction, key); }));
  MORTISE_RETURN_IF_ERROR(TaskError(finished));
  v1::ReportTaskRequest report;
  if (!report.ParseFromString(finished.result)) {
    return absl::InternalError("the worker's result cannot be read");
  }
  MORTISE_ASSIGN_OR_RETURN(const operations::Operation operation,
                           run.operations.Get(context.name()));
  const v1::Analysis analysis = AnalysisOf(operation, task, report);
  v1::Analysis kept;
  MORTISE_RETURN_IF_ERROR(context.Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(kept, KeepAnalysis(transaction, analysis, task.trace_id()));
    return absl::OkStatus();
  }));
  progress.TellEnd();
  return rpc::PackResult(kept);
}

}  // namespace

void RegisterAnalysis(operations::Operations& operations,
                      const std::shared_ptr<SimulatorCore>& core) {
  operations.Register(
      operations::kAnalysisOperation,
      [core, &operations](operations::OperationContext& context) {
        return Analyse({*core, operations, context});
      },
      CancelTask);
}

}  // namespace mortise::simulator
