// What the adapters of one simulator process share: the queue, who waits for it, the catalog.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/host/idle_workers.h"
#include "common/host/run_service.h"
#include "services/simulator/service/evaluation_tasks.h"
#include "services/simulator/service/leased_task_cache.h"
#include "services/simulator/worker/template_source.h"

namespace mortise::store {
class BlobFolder;
}
namespace mortise::v1 {
class EvaluationResult;
class Material;
}  // namespace mortise::v1

namespace mortise::simulator {

// Thread safe. Lives as long as anything that holds it.
class SimulatorCore : public std::enable_shared_from_this<SimulatorCore> {
 public:
  static absl::StatusOr<std::shared_ptr<SimulatorCore>> Create(
      const rpc::ServiceEnvironment& environment);

  store::Store* store() const { return store_; }
  rpc::Dispatcher* dispatcher() const { return dispatcher_; }
  TaskWaiters& waiters() { return waiters_; }
  TemplateSource& templates() { return *templates_; }
  LeasedTaskCache& leased_tasks() { return leased_tasks_; }

  // Returns a material of the catalog. NOT_FOUND, UNAVAILABLE.
  absl::StatusOr<v1::Material> GetMaterial(const std::string& name, const rpc::Origin& origin);

  // Whether the file of shape and fields that a result names, if it names one, is there; it then
  // counts as new, and stays for as long as one that has just been uploaded.
  bool KeepsFileOf(const v1::EvaluationResult& result) const;

  // Calls made in the background, as this service.
  rpc::Origin OwnOrigin(const std::string& trace_id, absl::Duration timeout) const;

  // Queues tasks or finds them, all in one transaction, and wakes waiting workers. See
  // FindOrEnqueue; results whose file is gone are computed again.
  absl::StatusOr<std::vector<FoundTask>> Enqueue(const std::vector<WantedTask>& wanted);

  // Cancels a task that still waits for a worker, unless somebody waits for it.
  void CancelIfQueued(const std::string& key);

  // Cancels a task that has not finished, unless somebody waits for it. A worker that has it drops
  // it when it next renews its lease.
  void CancelUnfinished(const std::string& key);

  // Does that to those that nobody has begun to wait for again after a moment: streams that break
  // off with a restart are asked for again, those of cancelled work are not.
  void CancelUnlessWantedAgain(std::vector<std::string> keys);

  // Leases tasks, puts aside poisonous ones and tells those who wait for them. NOT_FOUND for the
  // queue of an evaluator that is not registered.
  absl::StatusOr<std::vector<store::Task>> Lease(const std::string& queue,
                                                 const std::string& worker, int limit,
                                                 absl::Duration lease);

  // Returns who waits for work.
  rpc::IdleWorkers& idle_workers() { return *idle_workers_; }

  // Tells of work, and asks those who wait for it.
  void WakeWorkers() { idle_workers_->Wake(); }

  // Begins the regular look at the store: for results that another replica took, for leases that
  // ran out. It ends with the core.
  void KeepWatching();

 private:
  explicit SimulatorCore(const rpc::ServiceEnvironment& environment);
  absl::Status Remember(store::ReadTransaction& transaction, const std::string& queue,
                        const std::vector<store::Task>& leased);
  void LookAtStore();
  // Returns some of the keys, which ascend: those after the ones of the last look, round and round.
  std::vector<std::string> NextOf(const std::vector<std::string>& keys);
  void Cancel(const std::string& key, bool even_if_leased);

  store::Store* const store_;
  store::BlobFolder* blobs_ = nullptr;
  rpc::Dispatcher* const dispatcher_;
  const rpc::IdentitySigner* const signer_;
  std::shared_ptr<grpc::Channel> catalog_;
  std::unique_ptr<TemplateSource> templates_;
  TaskWaiters waiters_;
  LeasedTaskCache leased_tasks_;
  std::string looked_up_to_;  // key; used by LookAtStore alone
  const std::shared_ptr<rpc::IdleWorkers> idle_workers_;
};

}  // namespace mortise::simulator
