#include "common/host/idle_workers.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "common/rpc/dispatcher.h"

namespace mortise::rpc {
namespace {

// How soon news is noticed that came to another replica, or comes from nobody: an expired lease.
constexpr absl::Duration kLookInterval = absl::Milliseconds(250);

}  // namespace

std::shared_ptr<IdleWorkers> IdleWorkers::Create(Dispatcher* dispatcher) {
  std::shared_ptr<IdleWorkers> workers(new IdleWorkers(dispatcher));
  workers->KeepWatching();
  return workers;
}

void IdleWorkers::KeepWatching() {
  dispatcher_->SubmitAfter(kLookInterval, [weak = weak_from_this()] {
    const auto workers = weak.lock();
    if (workers == nullptr) return;
    bool is_idle = false;
    {
      const std::lock_guard lock(workers->mutex_);
      is_idle = !workers->idle_.empty();
    }
    if (is_idle) workers->Wake();
    workers->KeepWatching();
  });
}

void IdleWorkers::WhenWork(const std::string& queue, absl::Time deadline, Attempt attempt) {
  const std::uint64_t before = wakes_;
  bool others_wait = false;
  {
    const std::lock_guard lock(mutex_);
    others_wait = std::any_of(idle_.begin(), idle_.end(),
                              [&](const IdleWorker& worker) { return worker.queue == queue; });
  }
  if (attempt(others_wait)) return;
  {
    const std::lock_guard lock(mutex_);
    idle_.push_back({queue, deadline, std::move(attempt)});
  }
  if (wakes_ != before) Wake();  // which may have come too early for this one
}

// Thousands of tasks may come at once: all that come before the workers are asked wake them once.
void IdleWorkers::Wake() {
  ++wakes_;
  if (is_waking_.exchange(true)) return;
  dispatcher_->Submit([weak = weak_from_this()] {
    if (const auto workers = weak.lock()) workers->Ask();
  });
}

void IdleWorkers::Ask() {
  is_waking_ = false;
  const std::uint64_t before = wakes_;
  std::vector<IdleWorker> idle;
  {
    const std::lock_guard lock(mutex_);
    idle.swap(idle_);
  }
  std::vector<IdleWorker> still_idle;
  std::map<std::string, int> waiting;  // for each queue, who has not been asked
  for (const IdleWorker& worker : idle) ++waiting[worker.queue];
  std::set<std::string> empty;  // queues
  const absl::Time now = absl::Now();
  for (IdleWorker& worker : idle) {
    const bool others_wait = --waiting[worker.queue] > 0;
    const bool is_worth_asking = empty.count(worker.queue) == 0 || now >= worker.deadline;
    if (is_worth_asking && worker.attempt(others_wait)) continue;
    empty.insert(worker.queue);
    still_idle.push_back(std::move(worker));
  }
  if (still_idle.empty()) return;
  {
    const std::lock_guard lock(mutex_);
    idle_.insert(idle_.begin(), std::make_move_iterator(still_idle.begin()),
                 std::make_move_iterator(still_idle.end()));
  }
  if (wakes_ != before) Wake();  // news of meanwhile found none of these
}

}  // namespace mortise::rpc
