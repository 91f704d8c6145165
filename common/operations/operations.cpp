// Each kind of operation has a queue of tasks in the store, one task an operation. The dispatcher,
// a thread, leases tasks as pool threads are free, renews the leases of running ones, writes down
// their progress, and looks after what other replicas changed.
#include "common/operations/operations.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/base/thread_pool.h"
#include "common/operations/bell.h"
#include "common/operations/operation_records.h"
#include "common/operations/operation_run.h"
#include "common/operations/operation_watches.h"

namespace mortise::operations {
namespace {

std::string QueueOf(const std::string& kind) { return "operations/" + kind; }

bool OwnershipLost(const absl::Status& status) {
  const std::string reason = DetailOf(status).reason;
  return reason == "STALE_ATTEMPT" || reason == "TASK_CANCELLED" || reason == "TASK_FINISHED" ||
         absl::IsNotFound(status);
}

absl::Status CheckOptions(const OperationsOptions& options) {
  if (!IsResourceId(options.service)) {
    return InvalidField("service", "must be lower-case letters, digits and hyphens");
  }
  if (options.owner.empty()) return InvalidField("owner", "must not be empty");
  if (options.threads < 1) return InvalidField("threads", "must be at least 1");
  if (options.max_attempts < 1) return InvalidField("max_attempts", "must be at least 1");
  for (const absl::Duration duration : {options.lease, options.progress_interval, options.poll}) {
    if (duration < absl::Milliseconds(1) || duration > absl::Hours(24)) {
      return InvalidField("lease, progress_interval, poll", "must be a millisecond to a day");
    }
  }
  return absl::OkStatus();
}

class StoredOperations final : public Operations {
 public:
  StoredOperations(const OperationsOptions& options, store::Store* store)
      : options_(options), store_(store), records_(options.service, options.describe) {}
  ~StoredOperations() override;

  void Register(const std::string& kind, OperationHandler handler,
                CancelWithOperation cancel_with) override {
    handlers_[kind] = std::move(handler);
    cancel_with_[kind] = std::move(cancel_with);
  }
  absl::Status Resume() override;
  absl::StatusOr<Operation> Start(store::Transaction& transaction,
                                  const NewOperation& operation) override;
  absl::StatusOr<Operation> Get(std::string_view name) override;
  absl::StatusOr<std::vector<Operation>> List(std::string_view after_name, int limit) override;
  absl::Status Visit(std::string_view after_name, const OperationFilter& filter,
                     const std::function<Visitor()>& begin) override;
  absl::StatusOr<Operation> Cancel(std::string_view name) override;
  absl::StatusOr<Operation> Wait(std::string_view name, absl::Time deadline) override;
  absl::StatusOr<std::unique_ptr<OperationWatch>> Watch(
      std::string_view name, std::function<void(const Operation&)> callback) override;

 private:
  using RunPointer = std::shared_ptr<OperationRun>;

  // The dispatcher.
  void Dispatch();
  void LeaseWork(const std::string& kind);
  absl::StatusOr<Operation> FailQuarantined(store::Transaction& transaction,
                                            const store::Task& task);
  void RenewLeases();
  void FlushProgress();
  void LookAtOthersChanges();

  // A run.
  absl::StatusOr<RunPointer> Begin(const store::Task& task);
  void Run(const RunPointer& run, const OperationHandler& handler);
  absl::StatusOr<std::string> CallHandler(OperationRun* run, const OperationHandler& handler);
  absl::Status Finish(OperationRun* run, const absl::StatusOr<std::string>& outcome);
  absl::Status FlushProgress(OperationRun* run);
  std::vector<RunPointer> Runs();
  RunPointer RunOf(const std::string& id);

  const OperationsOptions options_;
  store::Store* const store_;
  OperationRecords records_;
  OperationWatches watches_;
  std::map<std::string, OperationHandler> handlers_;        // constant after Resume
  std::map<std::string, CancelWithOperation> cancel_with_;  // constant after Resume
  // Shared with transactions, whose commit may come after the end of this object.
  std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  std::mutex mutex_;
  std::map<std::string, RunPointer> runs_;  // by operation id; guarded by mutex_
  std::mutex leasing_mutex_;                // held from a look for work to its submission
  bool draining_ = false;                   // no new runs; guarded by leasing_mutex_
  std::atomic<bool> stopping_ = false;      // the dispatcher ends
  std::unique_ptr<ThreadPool> pool_;
  std::thread dispatcher_;
};

StoredOperations::~StoredOperations() {
  {
    std::lock_guard lock(leasing_mutex_);
    draining_ = true;
  }
  for (const RunPointer& run : Runs()) run->Interrupt();
  pool_.reset();  // the dispatcher goes on renewing leases until the handlers have returned
  stopping_ = true;
  bell_->Ring();
  if (dispatcher_.joinable()) dispatcher_.join();
}

absl::Status StoredOperations::Resume() {
  if (dispatcher_.joinable()) {
    return PreconditionFailed("OPERATIONS_RESUMED", "operations are running already");
  }
  for (const auto& [kind, handler] : handlers_) {
    const std::string queue = QueueOf(kind);
    MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) {
      return transaction.ExpireLeases(queue, options_.owner).status();
    }));
  }
  pool_ = std::make_unique<ThreadPool>(options_.threads);
  dispatcher_ = std::thread([this] { Dispatch(); });
  return absl::OkStatus();
}

absl::StatusOr<Operation> StoredOperations::Start(store::Transaction& transaction,
                                                  const NewOperation& request) {
  if (!handlers_.contains(request.kind)) {
    return InvalidField("kind", absl::StrCat("no operation of kind '", request.kind, "' is known"));
  }
  MORTISE_ASSIGN_OR_RETURN(Operation operation, records_.Create(transaction, request));
  MORTISE_ASSIGN_OR_RETURN(const std::string id, records_.IdOf(operation.name));
  MORTISE_RETURN_IF_ERROR(transaction.EnqueueTask(
      {.queue = QueueOf(request.kind), .key = id, .max_attempts = options_.max_attempts}));
  transaction.AfterCommit([bell = bell_] { bell->Ring(); });
  return operation;
}

absl::StatusOr<Operation> StoredOperations::Get(std::string_view name) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id, records_.IdOf(name));
  Operation operation;
  MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(operation, records_.Load(transaction, id));
    return absl::OkStatus();
  }));
  return operation;
}

absl::StatusOr<std::vector<Operation>> StoredOperations::List(std::string_view after_name,
                                                              int limit) {
  std::string after_id;
  if (!after_name.empty()) {
    MORTISE_ASSIGN_OR_RETURN(after_id, records_.IdOf(after_name));
  }
  std::vector<Operation> operations;
  MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(operations, records_.List(transaction, after_id, limit));
    return absl::OkStatus();
  }));
  return operations;
}

absl::Status StoredOperations::Visit(std::string_view after_name, const OperationFilter& filter,
                                     const std::function<Visitor()>& begin) {
  std::string after_id;
  if (!after_name.empty()) {
    MORTISE_ASSIGN_OR_RETURN(after_id, records_.IdOf(after_name));
  }
  return store_->Read([&](store::ReadTransaction& transaction) {
    return records_.Visit(transaction, after_id, filter, begin());
  });
}

// Whether nobody can be running this task now: it may be cancelled on the spot.
bool IsIdle(const store::Task& task, absl::Time now) {
  return task.state == store::TaskState::kQueued ||
         (task.state == store::TaskState::kLeased && task.lease_expires_at <= now);
}

absl::StatusOr<Operation> StoredOperations::Cancel(std::string_view name) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id, records_.IdOf(name));
  Operation operation;
  bool changed = false;
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(operation, records_.Load(transaction, id));
    changed = !IsFinal(operation.state) && !operation.cancel_requested;
    if (!changed) return absl::OkStatus();
    operation.cancel_requested = true;
    const std::string queue = QueueOf(operation.kind);
    MORTISE_ASSIGN_OR_RETURN(const store::Task task, transaction.GetTask(queue, id));
    if (!IsIdle(task, transaction.Now())) return records_.Save(transaction, "", &operation);
    MORTISE_RETURN_IF_ERROR(transaction.CancelTask(queue, id));
    operation.state = OperationState::kCancelled;
    operation.error = absl::CancelledError("cancelled before it ran");
    const auto cancel_with = cancel_with_.find(operation.kind);
    if (cancel_with != cancel_with_.end() && cancel_with->second) {
      MORTISE_RETURN_IF_ERROR(cancel_with->second(transaction, operation));
    }
    return records_.Save(transaction, "cancelled", &operation);
  }));
  if (!changed) return operation;
  if (const RunPointer run = RunOf(id)) run->Cancel();
  watches_.Notify(operation);
  return operation;
}

absl::StatusOr<std::unique_ptr<OperationWatch>> StoredOperations::Watch(
    std::string_view name, std::function<void(const Operation&)> callback) {
  if (!callback) return InvalidField("callback", "must be set");
  MORTISE_RETURN_IF_ERROR(records_.IdOf(name).status());
  // Registered before the read, so that no change falls between the two.
  std::unique_ptr<OperationWatch> watch = watches_.Add(std::string(name), std::move(callback));
  MORTISE_ASSIGN_OR_RETURN(const Operation operation, Get(name));
  watches_.Notify(operation);
  return watch;
}

absl::StatusOr<Operation> StoredOperations::Wait(std::string_view name, absl::Time deadline) {
  std::mutex mutex;
  std::condition_variable changed;
  bool finished = false;
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<OperationWatch> watch,
                           Watch(name, [&](const Operation& operation) {
                             std::lock_guard lock(mutex);
                             finished = IsFinal(operation.state);
                             changed.notify_one();
                           }));
  {
    // wait_for, not wait_until: the far future does not fit into a system_clock time.
    const absl::Duration patience = std::min(deadline - absl::Now(), absl::Hours(24 * 365));
    std::unique_lock lock(mutex);
    changed.wait_for(lock, absl::ToChronoNanoseconds(patience), [&] { return finished; });
  }
  return Get(name);
}

// ---- The dispatcher ----------------------------------------------------------------------------

void StoredOperations::Dispatch() {
  const absl::Duration step =
      std::min({options_.progress_interval, options_.poll, options_.lease / 3});
  absl::Time next_renewal = absl::Now() + options_.lease / 3;
  absl::Time next_look = absl::Now();
  while (!stopping_) {
    if (absl::Now() >= next_renewal) {
      RenewLeases();
      next_renewal = absl::Now() + options_.lease / 3;
    }
    // After the renewal: else a process that stood still would lease what it is running.
    for (const auto& [kind, handler] : handlers_) LeaseWork(kind);
    FlushProgress();
    if (absl::Now() >= next_look) {
      LookAtOthersChanges();
      next_look = absl::Now() + options_.poll;
    }
    bell_->Wait(step);
  }
}

void StoredOperations::LeaseWork(const std::string& kind) {
  std::lock_guard leasing(leasing_mutex_);  // what is leased here reaches the pool
  const int free = draining_ ? 0 : options_.threads - static_cast<int>(Runs().size());
  if (free <= 0) return;
  store::LeaseResult work;
  std::vector<Operation> failed;
  const absl::Status status =
      store_->Transact([&](store::Transaction& transaction) -> absl::Status {
        failed.clear();
        MORTISE_ASSIGN_OR_RETURN(
            work, transaction.LeaseTasks(QueueOf(kind), options_.owner, free, options_.lease));
        for (const store::Task& task : work.quarantined) {
          MORTISE_ASSIGN_OR_RETURN(failed.emplace_back(), FailQuarantined(transaction, task));
        }
        return absl::OkStatus();
      });
  if (!status.ok()) {
    Log(LogLevel::kWarning, "operations cannot be leased", {{"error", status.ToString()}});
    return;
  }
  for (const Operation& operation : failed) watches_.Notify(operation);
  for (const store::Task& task : work.leased) {
    absl::StatusOr<RunPointer> run = Begin(task);
    if (!run.ok()) {
      Log(LogLevel::kWarning, "an operation cannot begin",
          {{"operation", task.key}, {"error", run.status().ToString()}});
      continue;
    }
    {
      std::lock_guard lock(mutex_);
      RunPointer& present = runs_[task.key];
      if (present != nullptr) present->LoseLease();  // of an earlier attempt
      present = *run;
    }
    const OperationHandler& handler = handlers_.at(kind);
    pool_->Submit([this, run = *run, &handler] { Run(run, handler); });
  }
}

absl::StatusOr<Operation> StoredOperations::FailQuarantined(store::Transaction& transaction,
                                                            const store::Task& task) {
  MORTISE_ASSIGN_OR_RETURN(Operation operation, records_.Load(transaction, task.key));
  if (IsFinal(operation.state)) return operation;
  operation.state = OperationState::kFailed;
  operation.error = WithDetail(absl::InternalError("its process ended every time it ran"),
                               {"OPERATION_CRASHES", operation.name});
  MORTISE_RETURN_IF_ERROR(records_.Save(transaction, "failed", &operation));
  return operation;
}

void StoredOperations::RenewLeases() {
  for (const RunPointer& run : Runs()) {
    const absl::Status status =
        run->TransactAsOwner([](store::Transaction&) { return absl::OkStatus(); });
    if (OwnershipLost(status)) run->LoseLease();
  }
}

void StoredOperations::FlushProgress() {
  for (const RunPointer& run : Runs()) {
    const absl::Status status = FlushProgress(run.get());
    if (!status.ok() && !OwnershipLost(status)) {
      Log(LogLevel::kWarning, "progress cannot be saved",
          {{"operation", run->name()}, {"error", status.ToString()}});
    }
  }
}

absl::Status StoredOperations::FlushProgress(OperationRun* run) {
  const std::optional<Progress> progress = run->TakeProgress();
  if (!progress) return absl::OkStatus();
  Operation operation;
  MORTISE_RETURN_IF_ERROR(
      run->TransactAsOwner([&](store::Transaction& transaction) -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(operation, records_.Load(transaction, run->lease().id));
        operation.progress = *progress;
        return records_.Save(transaction, "progressed", &operation);
      }));
  watches_.Notify(operation);
  return absl::OkStatus();
}

// What other replicas did: they may have cancelled what runs here, or run what is watched here.
void StoredOperations::LookAtOthersChanges() {
  std::set<std::string> names = watches_.Names();
  for (const RunPointer& run : Runs()) names.insert(run->name());
  for (const std::string& name : names) {
    absl::StatusOr<Operation> operation = Get(name);
    if (!operation.ok()) continue;
    watches_.Notify(*operation);
    if (!operation->cancel_requested) continue;
    if (const RunPointer run = RunOf(*records_.IdOf(name))) run->Cancel();
  }
}

// ---- A run -------------------------------------------------------------------------------------

absl::StatusOr<StoredOperations::RunPointer> StoredOperations::Begin(const store::Task& task) {
  const RunLease lease{
      .queue = task.queue, .id = task.key, .attempt = task.attempt, .duration = options_.lease};
  Operation operation;
  std::string checkpoint;
  bool changed = false;
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(
        transaction.RenewLease(lease.queue, lease.id, lease.attempt, lease.duration));
    MORTISE_ASSIGN_OR_RETURN(operation, records_.Load(transaction, task.key));
    MORTISE_ASSIGN_OR_RETURN(checkpoint, records_.LoadCheckpoint(transaction, task.key));
    changed = operation.state == OperationState::kPending;
    if (!changed) return absl::OkStatus();
    operation.state = OperationState::kRunning;
    return records_.Save(transaction, "started", &operation);
  }));
  if (changed) watches_.Notify(operation);
  return std::make_shared<OperationRun>(lease, operation, std::move(checkpoint), store_, &records_);
}

void StoredOperations::Run(const RunPointer& run, const OperationHandler& handler) {
  const absl::StatusOr<std::string> outcome = CallHandler(run.get(), handler);
  absl::Status status = Finish(run.get(), outcome);
  if (!status.ok()) status = Finish(run.get(), status);  // a result too large to store, say
  if (!status.ok()) {
    // The lease runs out, and the operation runs again.
    Log(LogLevel::kError, "the end of an operation cannot be recorded",
        {{"operation", run->name()}, {"error", status.ToString()}});
  }
  {
    std::lock_guard lock(mutex_);
    const auto present = runs_.find(run->lease().id);
    if (present != runs_.end() && present->second == run) runs_.erase(present);
  }
  bell_->Ring();
}

absl::StatusOr<std::string> StoredOperations::CallHandler(OperationRun* run,
                                                          const OperationHandler& handler) {
  const TraceScope trace(run->trace_id());
  try {
    return handler(*run);
  } catch (const std::exception& error) {
    return WithDetail(absl::InternalError(absl::StrCat("the operation threw: ", error.what())),
                      {"OPERATION_THREW", run->name()});
  }
}

absl::Status StoredOperations::Finish(OperationRun* run,
                                      const absl::StatusOr<std::string>& outcome) {
  if (run->lost()) return absl::OkStatus();  // another replica has it
  const RunLease& lease = run->lease();
  // Taken or not: the dispatcher may have taken it and come too late to save it.
  const std::optional<Progress> progress = run->last_progress();
  Operation operation;
  bool released = false;
  const absl::Status status =
      store_->Transact([&](store::Transaction& transaction) -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(operation, records_.Load(transaction, lease.id));
        if (progress) operation.progress = *progress;
        released = !outcome.ok() && run->interrupted() && !operation.cancel_requested;
        if (released) {
          MORTISE_RETURN_IF_ERROR(transaction.ReleaseTask(lease.queue, lease.id, lease.attempt));
          return records_.Save(transaction, "", &operation);
        }
        MORTISE_RETURN_IF_ERROR(
            transaction.CompleteTask(lease.queue, lease.id, lease.attempt, "").status());
        const bool cancelled = !outcome.ok() && operation.cancel_requested;
        operation.state = outcome.ok() ? OperationState::kSucceeded
                          : cancelled  ? OperationState::kCancelled
                                       : OperationState::kFailed;
        // Handlers tell of each piece as they begin it; none is left once they have succeeded.
        if (outcome.ok() && operation.progress.total > 0) {
          operation.progress.done = operation.progress.total;
        }
        operation.error = outcome.status();
        operation.result = outcome.ok() ? *outcome : cancelled ? run->kept_result() : "";
        if (!operation.result.empty()) {
          MORTISE_RETURN_IF_ERROR(records_.SaveResult(transaction, lease.id, operation.result));
        }
        return records_.Save(transaction, OperationStateName(operation.state), &operation);
      });
  if (OwnershipLost(status)) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(status);
  watches_.Notify(operation);
  return absl::OkStatus();
}

std::vector<StoredOperations::RunPointer> StoredOperations::Runs() {
  std::lock_guard lock(mutex_);
  std::vector<RunPointer> runs;
  for (const auto& [id, run] : runs_) runs.push_back(run);
  return runs;
}

StoredOperations::RunPointer StoredOperations::RunOf(const std::string& id) {
  std::lock_guard lock(mutex_);
  const auto found = runs_.find(id);
  return found == runs_.end() ? nullptr : found->second;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Operations>> Operations::Create(const OperationsOptions& options,
                                                               store::Store* store) {
  MORTISE_RETURN_IF_ERROR(CheckOptions(options));
  return std::make_unique<StoredOperations>(options, store);
}

}  // namespace mortise::operations
