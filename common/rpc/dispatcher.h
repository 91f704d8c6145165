// What all handlers of a process share: their threads, who may call, where changes are recorded.
//
// gRPC's own threads only hand calls over. Every handler runs on this pool, after the identity, the
// role and the request have been checked, and is followed by a log line and metrics.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/rpc/identity.h"

namespace prometheus {
class Registry;
}
namespace mortise::store {
class Store;
}

namespace mortise::rpc {

class CallState;

// What work stands in line for. Each has threads of its own, so that none waits for another's.
enum class Lane {
  kCalls,    // calls that are answered when their work is done
  kStreams,  // streams to clients, and calls that wait for something to happen
  kUrgent,   // what must be done at once, whatever the load, such as holding a machine
};

struct DispatcherOptions {
  std::string service = {};  // the process, named in audit records
  int threads = 8;           // that run handlers of calls; as many run those of streams
  // In flight in each lane; more are refused with RESOURCE_EXHAUSTED.
  int max_calls = 10000;
  store::Store* store = nullptr;  // of Mutation; may be null where there is none
  IdentityVerifier* verifier =
      nullptr;  // null: development, every caller is "users/developer", admin
  std::shared_ptr<prometheus::Registry> registry = {};  // request metrics go here; may be null
};

class Dispatcher {
 public:
  static std::unique_ptr<Dispatcher> Create(const DispatcherOptions& options);

  // All calls must have ended.
  virtual ~Dispatcher() = default;

  virtual const DispatcherOptions& options() const = 0;

  // Runs `work` on the handlers' threads. Exceptions are logged.
  virtual void Submit(std::function<void()> work, Lane lane = Lane::kCalls) = 0;

  // Runs `work` on the handlers' threads after `delay`; dropped at destruction.
  virtual void SubmitAfter(absl::Duration delay, std::function<void()> work,
                           Lane lane = Lane::kCalls) = 0;

  // Waits until nothing submitted is queued or running.
  virtual void WaitIdle() = 0;

  // Asks waiting calls to answer and endless streams to end (Call::OnStop, StreamOptions::endless),
  // and refuses new calls: UNAVAILABLE, SHUTTING_DOWN.
  virtual void BeginDrain() = 0;

  // Waits until no call is in flight; false if that took until `deadline`.
  virtual bool WaitForCalls(absl::Time deadline) = 0;

  // Returns how many calls are in flight.
  virtual int calls() const = 0;

  // For the wrappers of handler.h: a call begins and ends. Begin fails if there are too
  // many, or the end has begun.
  virtual absl::Status Begin(const std::shared_ptr<CallState>& call) = 0;
  virtual void End(const std::shared_ptr<CallState>& call, const absl::Status& status) = 0;
};

}  // namespace mortise::rpc
