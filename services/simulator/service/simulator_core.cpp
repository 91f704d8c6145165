#include "services/simulator/service/simulator_core.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/rpc/channel.h"
#include "common/rpc/dispatcher.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/service/evaluator_records.h"
#include "services/simulator/service/file_upkeep.h"
#include "services/simulator/service/task_progress.h"

namespace mortise::simulator {
namespace {

// How soon results are noticed that came to another replica.
constexpr absl::Duration kLookInterval = absl::Milliseconds(250);
constexpr std::size_t kKeysInOneLook = 256;

// How long the tasks of a stream that broke off are kept for who asks for them again: a service
// that restarts takes a second or two.
constexpr absl::Duration kTimeToAskAgain = absl::Seconds(3);

}  // namespace

SimulatorCore::SimulatorCore(const rpc::ServiceEnvironment& environment)
    : store_(environment.store),
      dispatcher_(environment.dispatcher),
      signer_(environment.signer),
      idle_workers_(rpc::IdleWorkers::Create(environment.dispatcher)) {}

absl::StatusOr<std::shared_ptr<SimulatorCore>> SimulatorCore::Create(
    const rpc::ServiceEnvironment& environment) {
  std::shared_ptr<SimulatorCore> core(new SimulatorCore(environment));
  MORTISE_ASSIGN_OR_RETURN(core->blobs_, environment.store->Blobs());
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

bool SimulatorCore::KeepsFileOf(const v1::EvaluationResult& result) const {
  if (!result.has_design_fields()) return true;
  return KeepYoung(*blobs_, result.design_fields().sha256()).ok();
}

rpc::Origin SimulatorCore::OwnOrigin(const std::string& trace_id, absl::Duration timeout) const {
  return rpc::OwnOrigin(signer_, rpc::Role::kDesigner, trace_id, timeout);
}

absl::StatusOr<std::vector<FoundTask>> SimulatorCore::Enqueue(
    const std::vector<WantedTask>& wanted) {
  std::vector<FoundTask> found;
  MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
    std::set<std::string> evaluators;
    for (const WantedTask& task : wanted) {
      // One that is deleted meanwhile would leave a task that no worker can get.
      const std::string queue = QueueOf(task.key);
      if (IsEvaluatorName(queue) && evaluators.insert(queue).second) {
        MORTISE_RETURN_IF_ERROR(kEvaluators.Get(transaction, queue, "subject").status());
      }
    }
    MORTISE_ASSIGN_OR_RETURN(
        found, FindOrEnqueue(transaction, wanted, [this](const store::Task& task) {
          v1::ReportTaskRequest report;
          return report.ParseFromString(task.result) && KeepsFileOf(report.result());
        }));
    return absl::OkStatus();
  }));
  const bool has_work =
      std::any_of(found.begin(), found.end(), [](const FoundTask& task) { return !task.finished; });
  if (has_work) WakeWorkers();
  return found;
}

void SimulatorCore::CancelIfQueued(const std::string& key) { Cancel(key, false); }

void SimulatorCore::CancelUnfinished(const std::string& key) { Cancel(key, true); }

void SimulatorCore::CancelUnlessWantedAgain(std::vector<std::string> keys) {
  if (keys.empty()) return;
  dispatcher_->SubmitAfter(kTimeToAskAgain, [weak = weak_from_this(), keys = std::move(keys)] {
    const auto core = weak.lock();
    if (core == nullptr) return;
    for (const std::string& key : keys) core->CancelUnfinished(key);
  });
}

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
        if (IsEvaluatorName(queue)) {
          MORTISE_RETURN_IF_ERROR(Remember(transaction, queue, result.leased));
        }
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

// Whoever deletes an evaluator cancels its tasks, so that of a queue that has some it need not be
// looked for.
absl::Status SimulatorCore::Remember(store::ReadTransaction& transaction, const std::string& queue,
                                     const std::vector<store::Task>& leased) {
  if (leased.empty()) return kEvaluators.Get(transaction, queue, "evaluator").status();
  for (const store::Task& task : leased) {
    LeasedTask kept;
    if (!kept.task.ParseFromString(task.payload)) continue;  // its report will tell
    kept.evaluator = leased_tasks_.FindEvaluator(kept.task.digest());
    if (kept.evaluator == nullptr) {
      MORTISE_ASSIGN_OR_RETURN(v1::Evaluator evaluator,
                               kEvaluators.Get(transaction, queue, "evaluator"));
      // Another of the same name, since the task was queued: its report will tell.
      if (EvaluatorDigest(evaluator) != kept.task.digest()) continue;
      kept.evaluator = leased_tasks_.PutEvaluator(kept.task.digest(), std::move(evaluator));
    }
    leased_tasks_.Put(task.key, std::move(kept));
  }
  return absl::OkStatus();
}

void SimulatorCore::KeepWatching() {
  dispatcher_->SubmitAfter(kLookInterval, [weak = weak_from_this()] {
    const auto core = weak.lock();
    if (core == nullptr) return;
    core->LookAtStore();
    core->KeepWatching();
  });
}

// Thousands may be awaited; what another replica finished can wait for a few looks.
std::vector<std::string> SimulatorCore::NextOf(const std::vector<std::string>& keys) {
  const auto begin = static_cast<std::size_t>(
      std::upper_bound(keys.begin(), keys.end(), looked_up_to_) - keys.begin());
  std::vector<std::string> next;
  for (std::size_t i = 0; i < std::min(keys.size(), kKeysInOneLook); ++i) {
    next.push_back(keys[(begin + i) % keys.size()]);
  }
  looked_up_to_ = next.empty() ? "" : next.back();
  return next;
}

void SimulatorCore::LookAtStore() {
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
  const std::vector<std::string> some = NextOf(keys);
  const absl::Status status = store_->Read([&](store::ReadTransaction& transaction) {
    finished.clear();
    for (const std::string& key : some) {
      absl::StatusOr<store::Task> task = transaction.GetTask(QueueOf(key), key);
      if (task.ok() && IsFinished(*task)) finished.push_back(*std::move(task));
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return;
  for (const store::Task& task : finished) waiters_.Notify(task, false);
}

}  // namespace mortise::simulator
