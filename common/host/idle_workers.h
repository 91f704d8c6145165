// Those who wait for work: a call of a worker is kept open until there is a task for it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/rpc/call.h"
#include "common/rpc/handler.h"

namespace mortise::rpc {

class Dispatcher;

// Thread safe. Lives as long as anything that holds it.
class IdleWorkers : public std::enable_shared_from_this<IdleWorkers> {
 public:
  // The dispatcher outlives it.
  static std::shared_ptr<IdleWorkers> Create(Dispatcher* dispatcher);

  // Takes work, or gives up; false to be asked again. It must be quick. Where others wait for work
  // of the same queue it should take no more than it can begin.
  using Attempt = std::function<bool(bool others_wait)>;

  // Calls `attempt` now, when there may be work in the queue, and after the deadline, until it
  // returns true. Where one found no work, others of its queue are not asked.
  void WhenWork(const std::string& queue, absl::Time deadline, Attempt attempt);

  // Tells of work, and asks those who wait for it.
  void Wake();

 private:
  explicit IdleWorkers(Dispatcher* dispatcher) : dispatcher_(dispatcher) {}

  // Somebody who waits for work.
  struct IdleWorker {
    std::string queue;
    absl::Time deadline;  // until when
    Attempt attempt;
  };

  void Ask();
  void KeepWatching();

  Dispatcher* const dispatcher_;
  std::mutex mutex_;
  std::vector<IdleWorker> idle_;          // guarded by mutex_
  std::atomic<bool> is_waking_ = false;   // they are about to be asked
  std::atomic<std::uint64_t> wakes_ = 0;  // how often there was news
};

// Answers a call with what `take` gives, as soon as that is not empty: at the latest after `wait`,
// or when the caller has gone, with an empty response. `take(others_wait)` returns
// absl::StatusOr<Response>; `is_empty(response)` tells whether to wait on.
template <class Response, class Take, class IsEmpty>
void RespondWhenWork(IdleWorkers& idle, const std::string& queue, absl::Duration wait,
                     const Call& call, Responder<Response> respond, Take take, IsEmpty is_empty) {
  // Answered once: by work, by the end of the wait, or because the caller has gone.
  struct Waiting {
    std::mutex mutex;
    bool answered = false;
    Responder<Response> respond;
  };
  const absl::Time deadline = absl::Now() + wait;
  auto waiting = std::make_shared<Waiting>();
  waiting->respond = std::move(respond);
  call.OnStop([waiting] {
    const std::lock_guard lock(waiting->mutex);
    if (std::exchange(waiting->answered, true)) return;
    waiting->respond(Response());
  });
  idle.WhenWork(queue, deadline, [=](bool others_wait) {
    const std::lock_guard lock(waiting->mutex);
    if (waiting->answered) return true;
    if (call.cancelled()) return true;  // OnStop answers
    absl::StatusOr<Response> taken = take(others_wait);
    if (taken.ok() && is_empty(*taken) && absl::Now() < deadline) return false;
    waiting->answered = true;
    waiting->respond(std::move(taken));
    return true;
  });
}

}  // namespace mortise::rpc
