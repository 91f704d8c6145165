#include "services/simulator/worker/worker.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <deque>
#include <mutex>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/host/file_quota.h"
#include "common/host/lease_keeper.h"
#include "common/host/worker_program.h"
#include "common/rpc/chunk_calls.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "services/simulator/worker/task_evaluation.h"
#include "services/simulator/worker/template_source.h"

namespace mortise::simulator {
namespace {

using Stub = v1::SimulatorService::Stub;

constexpr absl::Duration kCallTimeout = absl::Seconds(30);
constexpr absl::Duration kReportPatience = absl::Minutes(2);
// Tasks that take less than this together are leased ahead, so that a worker need not ask for each.
constexpr absl::Duration kAhead = absl::Milliseconds(250);
constexpr int kMaxAhead = 4;

// Tells that the worker will not do a task that it holds: others may have it, unharmed.
void GiveBack(const WorkerOptions& options, Stub& stub, const v1::Task& task) {
  v1::ReportTaskRequest report;
  report.mutable_task()->set_name(task.name());
  report.mutable_task()->set_attempt(task.attempt());
  *report.mutable_result()->mutable_error() =
      rpc::ToProto(absl::CancelledError("the worker gives it back"));
  const auto given = rpc::CallUnary<Stub, v1::ReportTaskRequest, v1::ReportTaskResponse>(
      stub, &Stub::ReportTask, report,
      rpc::OwnOrigin(options.signer, rpc::Role::kDesigner, task.trace_id(), kCallTimeout));
  Log(given.ok() ? LogLevel::kInfo : LogLevel::kWarning,
      given.ok() ? "task given back" : "a task could not be given back",
      {{"task", task.name()},
       {"attempt", task.attempt()},
       {"error", given.ok() ? "" : given.status().message()}});
}

// Tasks that are leased and not begun, in the order of their leases.
class Reserve {
 public:
  Reserve(const WorkerOptions& options, Stub& stub) : options_(options), stub_(stub) {}

  void Put(const v1::LeaseTasksResponse& leased) {
    const std::lock_guard lock(mutex_);
    tasks_.insert(tasks_.end(), leased.tasks().begin(), leased.tasks().end());
  }

  std::optional<v1::Task> Take() {
    const std::lock_guard lock(mutex_);
    if (tasks_.empty()) return std::nullopt;
    v1::Task task = std::move(tasks_.front());
    tasks_.pop_front();
    return task;
  }

  void GiveAllBack() {
    while (const std::optional<v1::Task> task = Take()) GiveBack(options_, stub_, *task);
  }

 private:
  const WorkerOptions& options_;
  Stub& stub_;
  std::mutex mutex_;
  std::deque<v1::Task> tasks_;  // guarded by mutex_
};

// How many tasks to lease at a time, by how long the last ones took.
class LeaseSize {
 public:
  int value() const {
    if (!seconds_) return 1;
    const double fit = absl::ToDoubleSeconds(kAhead) / std::max(*seconds_, 1e-6);
    return static_cast<int>(std::clamp(fit, 1.0, static_cast<double>(kMaxAhead)));
  }

  void Add(absl::Duration duration) {
    constexpr double kWeight = 0.5;  // of the last one
    const double seconds = absl::ToDoubleSeconds(duration);
    seconds_ = seconds_ ? (1 - kWeight) * *seconds_ + kWeight * seconds : seconds;
  }

 private:
  std::optional<double> seconds_;  // of a task
};

// Prolongs the lease of a task, and tells how far the work is; false once the task is lost.
bool Renew(const WorkerOptions& options, Stub& stub, const v1::Task& task,
           const StageProgress& progress) {
  v1::RenewLeasesRequest request;
  request.set_worker(options.name);
  request.set_lease_seconds(absl::ToDoubleSeconds(options.lease));
  v1::TaskAttempt& attempt = *request.add_tasks();
  attempt.set_name(task.name());
  attempt.set_attempt(task.attempt());
  // Of analyses, which people watch.
  if (const StageProgress::State state = progress.state(); task.fields() && state.total > 0) {
    attempt.mutable_progress()->set_stage(state.stage);
    attempt.mutable_progress()->set_done(state.done);
    attempt.mutable_progress()->set_total(state.total);
  }
  const auto renewed = rpc::CallUnary<Stub, v1::RenewLeasesRequest, v1::RenewLeasesResponse>(
      stub, &Stub::RenewLeases, request,
      rpc::OwnOrigin(options.signer, rpc::Role::kDesigner, task.trace_id(), options.lease / 3));
  if (renewed.ok()) return renewed->lost_size() == 0;
  Log(LogLevel::kWarning, "a lease was not renewed",
      {{"task", task.name()}, {"error", renewed.status().message()}});
  // A service that begins again is to be found again while this thread waits for nothing else.
  rpc::AwaitConnection(*options.simulator, options.lease / 3);
  return true;
}

absl::StatusOr<std::string> Upload(const WorkerOptions& options, Stub& stub,
                                   const std::string& trace_id, const std::string& bytes) {
  const auto context = rpc::MakeClientContext(
      rpc::OwnOrigin(options.signer, rpc::Role::kDesigner, trace_id, absl::Minutes(5)));
  v1::UploadBlobResponse response;
  const auto writer = stub.UploadBlob(context.get(), &response);
  rpc::SendChunks(bytes, *writer);
  MORTISE_RETURN_IF_ERROR(rpc::FromGrpc(writer->Finish()));
  return response.sha256();
}

// Receives a file that somebody uploaded.
absl::StatusOr<std::string> Download(const WorkerOptions& options, Stub& stub,
                                     const std::string& trace_id, const std::string& sha256,
                                     double limit) {
  const auto context = rpc::MakeClientContext(
      rpc::OwnOrigin(options.signer, rpc::Role::kDesigner, trace_id, absl::Minutes(5)));
  v1::DownloadBlobRequest request;
  request.set_sha256(sha256);
  const auto reader = stub.DownloadBlob(context.get(), request);
  MORTISE_ASSIGN_OR_RETURN(
      std::string bytes,
      rpc::ReceiveChunks(
          *context, *reader, static_cast<std::int64_t>(std::min(limit, 1e18)),
          TooLarge("the mesh's file",
                   absl::StrCat("the ", limit / 1e6, " MB that the worker has room for"))));
  if (Sha256Hex(bytes) == sha256) return bytes;
  return absl::UnavailableError("the mesh's file did not arrive as it was uploaded");
}

absl::Status OutOfTime(absl::Duration limit) {
  return WithDetail(absl::ResourceExhaustedError(absl::StrCat("the evaluation takes longer than ",
                                                              absl::FormatDuration(limit),
                                                              ", the limit of this worker")),
                    {kTimeLimit, ""});
}

// Reports an attempt that began at `start`.
void Report(const WorkerOptions& options, Stub& stub, const v1::Task& task,
            const v1::ReportTaskRequest& report, absl::Time start) {
  const auto reported = rpc::CallUnary<Stub, v1::ReportTaskRequest, v1::ReportTaskResponse>(
      stub, &Stub::ReportTask, report,
      rpc::OwnOrigin(options.signer, rpc::Role::kDesigner, task.trace_id(), kReportPatience),
      {.patience = kReportPatience});
  Log(reported.ok() ? LogLevel::kInfo : LogLevel::kWarning,
      reported.ok() ? "task reported" : "a report was refused",
      {{"task", task.name()},
       {"attempt", task.attempt()},
       {"seconds", absl::ToDoubleSeconds(absl::Now() - start)},
       {"outcome", report.result().has_error() ? report.result().error().message() : "done"},
       {"error", reported.ok() ? absl::string_view() : reported.status().message()}});
}

void WorkOn(const WorkerOptions& options, Stub& stub, TemplateSource& templates,
            const v1::Task& task, Reserve& reserve, const std::stop_token& ending) {
  const TraceScope trace(task.trace_id());
  const absl::Time start = absl::Now();
  StageProgress progress;
  const rpc::LeaseKeeper keeper({.lease = options.lease,
                                 .time_limit = options.time_limit,
                                 .drain_time = options.drain_time,
                                 .break_off = options.break_off},
                                {.renew = [&] { return Renew(options, stub, task, progress); },
                                 .give_back = [&] { GiveBack(options, stub, task); },
                                 .give_back_reserve = [&] { reserve.GiveAllBack(); }},
                                ending);
  v1::Analysis artifacts;
  const TaskContext context{
      .templates = templates,
      .origin = rpc::OwnOrigin(options.signer, rpc::Role::kDesigner, task.trace_id(), kCallTimeout),
      .keep = [&](const AnalysisFile& file) -> absl::Status {
        const absl::StatusOr<std::string> sha256 =
            Upload(options, stub, task.trace_id(), file.bytes);
        // Room may come: the work is not lost to a disk that is full for a while.
        if (DetailOf(sha256.status()).reason == rpc::kFileQuota) {
          return absl::UnavailableError(sha256.status().message());
        }
        MORTISE_RETURN_IF_ERROR(sha256.status());
        v1::Artifact* artifact = artifacts.add_artifacts();
        artifact->set_file_name(file.name);
        artifact->set_media_type(file.media_type);
        artifact->set_size(static_cast<int64_t>(file.bytes.size()));
        artifact->set_sha256(*sha256);
        return absl::OkStatus();
      },
      .upload =
          [&](const std::string& bytes) { return Upload(options, stub, task.trace_id(), bytes); },
      .fetch =
          [&](const std::string& sha256, double limit) {
            return Download(options, stub, task.trace_id(), sha256, limit);
          },
      .memory_limit = options.memory_limit,
      .threads = options.threads,
      .progress = &progress,
      .stop = keeper.stop_token()};
  v1::ReportTaskRequest report = EvaluateTask(task, context);
  if (keeper.lost()) {
    Log(LogLevel::kInfo, "a task was dropped, as nobody wants it from here any more",
        {{"task", task.name()}, {"attempt", task.attempt()}});
    return;
  }
  if (report.result().error().code() == static_cast<int>(absl::StatusCode::kCancelled) &&
      keeper.stop_token().stop_requested()) {
    *report.mutable_result()->mutable_error() = rpc::ToProto(OutOfTime(options.time_limit));
  }
  if (report.has_analysis()) {
    report.mutable_analysis()->mutable_artifacts()->Swap(artifacts.mutable_artifacts());
  }
  report.mutable_task()->set_name(task.name());
  report.mutable_task()->set_attempt(task.attempt());
  Report(options, stub, task, report, start);
}

}  // namespace

void RunWorker(const WorkerOptions& options, const std::stop_token& stop) {
  const auto stub = v1::SimulatorService::NewStub(options.simulator);
  TemplateSource templates(options.catalog);
  v1::LeaseTasksRequest request;
  request.set_worker(options.name);
  request.set_lease_seconds(absl::ToDoubleSeconds(options.lease));
  request.set_wait_seconds(absl::ToDoubleSeconds(options.patience));
  Reserve reserve(options, *stub);
  LeaseSize size;
  while (rpc::AwaitConnection(*options.simulator, stop)) {
    request.set_limit(size.value());
    const auto leased = rpc::CallUnary<Stub, v1::LeaseTasksRequest, v1::LeaseTasksResponse>(
        *stub, &Stub::LeaseTasks, request,
        rpc::OwnOrigin(options.signer, rpc::Role::kDesigner, "", options.patience + kCallTimeout),
        {.stop = stop});
    if (!leased.ok()) {
      if (stop.stop_requested()) break;
      Log(LogLevel::kWarning, "no tasks can be leased", {{"error", leased.status().message()}});
      // Refusals come at once; a worker that cannot work must not flood the service.
      if (!absl::IsUnavailable(leased.status())) rpc::Pause(absl::Seconds(1), stop);
      continue;
    }
    reserve.Put(*leased);
    while (const std::optional<v1::Task> task = reserve.Take()) {
      const absl::Time start = absl::Now();
      WorkOn(options, *stub, templates, *task, reserve, stop);
      size.Add(absl::Now() - start);
      if (stop.stop_requested()) reserve.GiveAllBack();
    }
  }
}

}  // namespace mortise::simulator
