#include "services/simulator/simulator_core.h"

#include <grpcpp/grpcpp.h>

#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/rpc/channel.h"
#include "common/rpc/dispatcher.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "services/simulator/evaluator_records.h"
#include "services/simulator/task_progress.h"

namespace mortise::simulator {
namespace {

// How soon news is noticed that came to another replica, or comes from nobody: an expired lease.
constexpr absl::Duration kLookInterval = absl::Milliseconds(250);

}  // namespace

SimulatorCore::SimulatorCore(const rpc::ServiceEnvironment& environment)
    : store_(environment.store), dispatcher_(environment.dispatcher), signer_(environment.signer) {}

absl::StatusOr<std::shared_ptr<SimulatorCore>> SimulatorCore::Create(
    const rpc::ServiceEnvironment& environment) {
  std::shared_ptr<SimulatorCore> core(new SimulatorCore(environment));
  MORTISE_ASSIGN_OR_RETURN(core->catalog_, environment.peers->Channel("catalog"));
  core->templates_ = std::make_unique<TemplateSource>(core->catalog_);
  core->KeepWatching();
  return core;
}

absl::StatusOr<v1::Material> SimulatorCore::GetMaterial(const std::string& name,
                                                        const rpc::Origin& origin) {
  const auto stub = v1::CatalogService::NewStub(catalog_);
  v1::GetMaterialRequest request;
  request.set_name(name);
  return rpc::CallUnary<v1::CatalogService::Stub, v1::GetMaterialRequest, v1::Material>(
      *stub, &v1::CatalogService::Stub::GetMaterial, request, origin);
}

rpc::Origin SimulatorCore::OwnOrigin(const std::string& trace_id, absl::Duration timeout) const {
  return rpc::OwnOrigin(signer_, rpc::Role::kDesigner, trace_id, timeout);
}

absl::StatusOr<store::Task> SimulatorCore::Enqueue(const std::string& key,
                                                   const std::string& payload, int priority,
                                                   bool& was_there) {
  store::Task task;
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    // One that is deleted meanwhile would leave a task that no worker can get.
    if (const std::string queue = QueueOf(key); IsEvaluatorName(queue)) {
      MORTISE_RETURN_IF_ERROR(GetEvaluator(transaction, queue, "subject").status());
    }
    MORTISE_ASSIGN_OR_RETURN(task, FindOrEnqueue(transaction, key, payload, priority, was_there));
    return absl::OkStatus();
  }));
  if (task.state == store::TaskState::kQueued) WakeWorkers();
  return task;
}

void SimulatorCore::CancelIfQueued(const std::string& key) { Cancel(key, false); }

void SimulatorCore::CancelUnfinished(const std::string& key) { Cancel(key, true); }

void SimulatorCore::Cancel(const std::string& key, bool even_if_leased) {
  const std::string queue = QueueOf(key);
  const absl::Status status =
      store_->Transact([&](store::Transaction& transaction) -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(const store::Task task, transaction.GetTask(queue, key));
        if (IsFinished(task) || waiters_.IsAwaited(key)) return absl::OkStatus();
        if (task.state == store::TaskState::kLeased && !even_if_leased) return absl::OkStatus();
        MORTISE_RETURN_IF_ERROR(transaction.CancelTask(queue, key));
        return ForgetProgress(transaction, key);
      });
  if (!status.ok()) {
    Log(LogLevel::kWarning, "an unwanted task goes on", {{"error", status.message()}});
  }
}

absl::StatusOr<std::vector<store::Task>> SimulatorCore::Lease(const std::string& queue,
                                                              const std::string& worker, int limit,
                                                              absl::Duration lease) {
  store::LeaseResult result;
  MORTISE_RETURN_IF_ERROR(store_->Transact(
      [&](store::Transaction& transaction) -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(result, transaction.LeaseTasks(queue, worker, limit, lease));
        for (const store::Task& task : result.quarantined) {
          MORTISE_RETURN_IF_ERROR(
              transaction.AppendEvent({.type = "task.quarantined",
                                       .subject = absl::StrCat("tasks/", task.key),
                                       .payload = "{}"}));
        }
        return absl::OkStatus();
      },
      store::Isolation::kReadCommitted));
  for (const store::Task& task : result.quarantined) {
    Log(LogLevel::kError, "a task ended its workers and was put aside",
        {{"task", task.key}, {"worker", task.worker}});
    waiters_.Notify(task, false);
  }
  return std::move(result.leased);
}

void SimulatorCore::WhenWork(std::function<bool()> attempt) {
  if (attempt()) return;
  const std::lock_guard lock(mutex_);
  idle_workers_.push_back(std::move(attempt));
}

void SimulatorCore::WakeWorkers() {
  dispatcher_->Submit([weak = weak_from_this()] {
    const auto core = weak.lock();
    if (core == nullptr) return;
    std::vector<std::function<bool()>> attempts;
    {
      const std::lock_guard lock(core->mutex_);
      attempts.swap(core->idle_workers_);
    }
    std::vector<std::function<bool()>> still_idle;
    for (auto& attempt : attempts) {
      if (!attempt()) still_idle.push_back(std::move(attempt));
    }
    const std::lock_guard lock(core->mutex_);
    for (auto& attempt : still_idle) core->idle_workers_.push_back(std::move(attempt));
  });
}

void SimulatorCore::KeepWatching() {
  dispatcher_->SubmitAfter(kLookInterval, [weak = weak_from_this()] {
    const auto core = weak.lock();
    if (core == nullptr) return;
    core->LookAtStore();
    core->KeepWatching();
  });
}

void SimulatorCore::LookAtStore() {
  bool idle = false;
  {
    const std::lock_guard lock(mutex_);
    idle = !idle_workers_.empty();
  }
  if (idle) WakeWorkers();
  const std::vector<std::string> keys = waiters_.Keys();
  if (keys.empty()) return;
  std::set<std::string> queues;
  for (const std::string& key : keys) queues.insert(QueueOf(key));
  for (const std::string& queue : queues) {
    const auto put_aside = Lease(queue, "service", 0, absl::Seconds(1));
    if (put_aside.ok()) continue;
    Log(LogLevel::kWarning, "a queue cannot be looked at",
        {{"queue", queue}, {"error", put_aside.status().message()}});
  }
  std::vector<store::Task> finished;
  const absl::Status status = store_->Read([&](store::ReadTransaction& transaction) {
    finished.clear();
    for (const std::string& key : keys) {
      absl::StatusOr<store::Task> task = transaction.GetTask(QueueOf(key), key);
      if (task.ok() && IsFinished(*task)) finished.push_back(*std::move(task));
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return;
  for (const store::Task& task : finished) waiters_.Notify(task, false);
}

}  // namespace mortise::simulator
