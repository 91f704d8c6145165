#include "services/simulator/worker/worker.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "services/simulator/worker/task_evaluation.h"
#include "services/simulator/worker/template_source.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;
using Stub = v1::SimulatorService::Stub;

constexpr absl::Duration kCallTimeout = absl::Seconds(30);
constexpr absl::Duration kReportPatience = absl::Minutes(2);
// How soon a worker notices that a task was cancelled, and tells how far it is.
constexpr absl::Duration kLookForCancel = absl::Seconds(2);

// How long work may take to stop that nobody wants any more.
constexpr absl::Duration kTimeToStop = absl::Seconds(3);

// Tasks that take less than this together are leased ahead, so that a worker need not ask for each.
constexpr absl::Duration kAhead = absl::Milliseconds(250);
constexpr int kMostAhead = 4;
// How long what was leased ahead waits behind a task that takes longer than was thought.
constexpr absl::Duration kReservePatience = absl::Seconds(1);

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
    return static_cast<int>(std::clamp(fit, 1.0, static_cast<double>(kMostAhead)));
  }

  void Add(absl::Duration duration) {
    constexpr double kWeight = 0.5;  // of the last one
    const double seconds = absl::ToDoubleSeconds(duration);
    seconds_ = seconds_ ? (1 - kWeight) * *seconds_ + kWeight * seconds : seconds;
  }

 private:
  std::optional<double> seconds_;  // of a task
};

// Renews the lease of one task, tells with it how far the work is, and asks for the work to stop
// once the lease is lost or the time is over. When the worker is asked to end, it gives the task
// back after the drain time. What is in reserve it gives back when the task takes long, or the
// worker is asked to end.
class LeaseKeeper {
 public:
  LeaseKeeper(const WorkerOptions& options, Stub& stub, const v1::Task& task, Reserve& reserve,
              const std::stop_token& ending)
      : options_(options),
        stub_(stub),
        task_(task),
        reserve_(reserve),
        interval_(absl::ToChronoNanoseconds(std::min(options.lease / 3, kLookForCancel))),
        thread_([this] { Run(); }),
        ending_(ending, [this] { BeginDrain(); }) {}

  ~LeaseKeeper() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  std::stop_token stop_token() const { return stop_.get_token(); }

  // What renewals tell.
  StageProgress& progress() { return progress_; }

  // Whether somebody has taken the task away: its result is not wanted.
  bool lost() const { return lost_; }

 private:
  // Of analyses, which people watch.
  void AddProgress(v1::TaskAttempt& attempt) const {
    const StageProgress::State state = progress_.state();
    if (!task_.fields() || state.total == 0) return;
    attempt.mutable_progress()->set_stage(state.stage);
    attempt.mutable_progress()->set_done(state.done);
    attempt.mutable_progress()->set_total(state.total);
  }

  void BeginDrain() {
    {
      const std::lock_guard lock(mutex_);
      give_back_at_ = Clock::now() + absl::ToChronoNanoseconds(options_.drain_time);
      empty_reserve_at_ = Clock::now();
    }
    changed_.notify_all();
  }

  void Run() {
    const Clock::time_point end = Clock::now() + absl::ToChronoNanoseconds(options_.time_limit);
    Clock::time_point renewal = Clock::now() + interval_;
    std::unique_lock lock(mutex_);
    while (!done_) {
      const Clock::time_point now = Clock::now();
      if (now >= give_back_at_) {
        lock.unlock();
        // Told before the work has stopped, which may take long: the sooner others begin with it.
        Drop();
        GiveBack(options_, stub_, task_);
        return AwaitStop();
      }
      if (now >= empty_reserve_at_) {
        empty_reserve_at_ = Clock::time_point::max();
        lock.unlock();
        reserve_.GiveAllBack();
        lock.lock();
        continue;
      }
      if (now < renewal) {
        changed_.wait_until(lock, std::min({renewal, give_back_at_, empty_reserve_at_}));
        continue;
      }
      lock.unlock();
      if (now > end) stop_.request_stop();
      if (!Renew()) return AwaitStop();
      renewal = Clock::now() + interval_;
      lock.lock();
    }
  }

  // After the task was lost: work that does not stop by itself is broken off.
  void AwaitStop() {
    std::unique_lock lock(mutex_);
    const bool stopped =
        changed_.wait_for(lock, absl::ToChronoNanoseconds(kTimeToStop), [this] { return done_; });
    if (stopped || !options_.break_off) return;
    Log(LogLevel::kInfo, "breaking off, as a dropped task does not stop", {{"task", task_.name()}});
    options_.break_off();
  }

  // False once the task is lost.
  bool Renew() {
    v1::RenewLeasesRequest request;
    request.set_worker(options_.name);
    request.set_lease_seconds(absl::ToDoubleSeconds(options_.lease));
    request.add_tasks()->set_name(task_.name());
    request.mutable_tasks(0)->set_attempt(task_.attempt());
    AddProgress(*request.mutable_tasks(0));
    const auto renewed = rpc::CallUnary<Stub, v1::RenewLeasesRequest, v1::RenewLeasesResponse>(
        stub_, &Stub::RenewLeases, request,
        rpc::OwnOrigin(options_.signer, rpc::Role::kDesigner, task_.trace_id(),
                       options_.lease / 3));
    if (!renewed.ok()) {
      Log(LogLevel::kWarning, "a lease was not renewed",
          {{"task", task_.name()}, {"error", renewed.status().message()}});
    } else if (renewed->lost_size() > 0) {
      Drop();
      return false;
    }
    return true;
  }

  void Drop() {
    lost_ = true;
    stop_.request_stop();
  }

  const WorkerOptions& options_;
  Stub& stub_;
  const v1::Task& task_;
  Reserve& reserve_;
  const Clock::duration interval_;
  StageProgress progress_;
  std::stop_source stop_;
  std::atomic<bool> lost_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;                                          // guarded by mutex_
  Clock::time_point give_back_at_ = Clock::time_point::max();  // guarded by mutex_
  Clock::time_point empty_reserve_at_ =
      Clock::now() + absl::ToChronoNanoseconds(kReservePatience);  // guarded by mutex_
  std::thread thread_;
  const std::stop_callback<std::function<void()>> ending_;  // last: gone before what it changes
};

absl::StatusOr<std::string> Upload(const WorkerOptions& options, Stub& stub,
                                   const std::string& trace_id, const std::string& bytes) {
  constexpr std::size_t kChunk = 512 * 1024;
  const auto context = rpc::MakeClientContext(
      rpc::OwnOrigin(options.signer, rpc::Role::kDesigner, trace_id, absl::Minutes(5)));
  v1::UploadBlobResponse response;
  const auto writer = stub.UploadBlob(context.get(), &response);
  for (std::size_t offset = 0; offset == 0 || offset < bytes.size(); offset += kChunk) {
    v1::Chunk chunk;
    chunk.set_offset(static_cast<int64_t>(offset));
    chunk.set_data(bytes.substr(offset, kChunk));
    if (offset == 0) chunk.set_total_size(static_cast<int64_t>(bytes.size()));
    if (!writer->Write(chunk)) break;
  }
  writer->WritesDone();
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
  std::string bytes;
  v1::Chunk chunk;
  while (reader->Read(&chunk)) {
    if (static_cast<double>(chunk.total_size()) > limit ||
        static_cast<double>(bytes.size() + chunk.data().size()) > limit) {
      context->TryCancel();
      while (reader->Read(&chunk)) {
      }
      reader->Finish();
      return TooLarge("the mesh's file",
                      absl::StrCat("the ", limit / 1e6, " MB that the worker has room for"));
    }
    bytes += chunk.data();
  }
  MORTISE_RETURN_IF_ERROR(rpc::FromGrpc(reader->Finish()));
  if (Sha256Hex(bytes) == sha256) return bytes;
  return absl::UnavailableError("the mesh's file did not arrive as it was uploaded");
}

absl::Status OutOfTime(absl::Duration limit) {
  return WithDetail(absl::ResourceExhaustedError(absl::StrCat("the evaluation takes longer than ",
                                                              absl::FormatDuration(limit),
                                                              ", the limit of this worker")),
                    {kTimeLimit, ""});
}

void WorkOn(const WorkerOptions& options, Stub& stub, TemplateSource& templates,
            const v1::Task& task, Reserve& reserve, const std::stop_token& ending) {
  const TraceScope trace(task.trace_id());
  const absl::Time start = absl::Now();
  LeaseKeeper keeper(options, stub, task, reserve, ending);
  v1::Analysis artifacts;
  const TaskContext surroundings{
      .templates = templates,
      .origin = rpc::OwnOrigin(options.signer, rpc::Role::kDesigner, task.trace_id(), kCallTimeout),
      .keep = [&](const AnalysisFile& file) -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(const std::string sha256,
                                 Upload(options, stub, task.trace_id(), file.bytes));
        v1::Artifact* artifact = artifacts.add_artifacts();
        artifact->set_file_name(file.name);
        artifact->set_media_type(file.media_type);
        artifact->set_size(static_cast<int64_t>(file.bytes.size()));
        artifact->set_sha256(sha256);
        return absl::OkStatus();
      },
      .fetch =
          [&](const std::string& sha256, double limit) {
            return Download(options, stub, task.trace_id(), sha256, limit);
          },
      .memory_limit = options.memory_limit,
      .threads = options.threads,
      .progress = &keeper.progress(),
      .stop = keeper.stop_token()};
  v1::ReportTaskRequest report = EvaluateTask(task, surroundings);
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

// Waits until the channel is connected; false if a stop is requested. Calls alone would not do: one
// that finds no connection fails at once, and a TLS handshake goes on only while somebody waits.
bool AwaitConnection(grpc::Channel& channel, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLookForStop{200};
  while (!stop.stop_requested()) {
    if (channel.WaitForConnected(std::chrono::system_clock::now() + kLookForStop)) return true;
  }
  return false;
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
  while (AwaitConnection(*options.simulator, stop)) {
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
