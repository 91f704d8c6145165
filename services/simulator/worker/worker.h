// A worker leases evaluation tasks from the simulator service, computes them in this process, and
// reports each with the attempt number it was lent under.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "absl/time/time.h"
#include "common/rpc/channel.h"

namespace mortise::simulator {

struct WorkerOptions {
  std::string name;                               // unique among the workers
  std::shared_ptr<grpc::Channel> simulator;       // where tasks come from
  std::shared_ptr<grpc::Channel> catalog;         // where templates come from
  const rpc::IdentitySigner* signer = nullptr;    // null in development; outlives the worker
  absl::Duration lease = absl::Seconds(30);       // renewed while computing
  absl::Duration time_limit = absl::Hours(2);     // of one task
  absl::Duration drain_time = absl::Seconds(10);  // of the task at hand, once a stop is requested
  absl::Duration patience = absl::Seconds(2);     // for a task, in one call
  int threads = 1;                                // that solve one task
  double memory_limit = 8e9;                      // bytes of one task

  // Ends the process, or starts it anew, with all that it does now. Called where work that nobody
  // wants any more has not stopped: what a library does in one call cannot be stopped. Unset: the
  // worker waits for it.
  std::function<void()> break_off = {};
};

// Works until a stop is requested. The task at hand is still finished and reported if that takes no
// longer than the drain time; else it is given back, unharmed and at once, so that others may have
// it, and dropped here. A task that is cancelled, or was lent to another meanwhile, is dropped,
// too: at its next step, or after three seconds with `break_off`. One that takes longer than the
// limit fails at its next step, RESOURCE_EXHAUSTED, TIME_LIMIT. A worker holds no state that
// matters; when it dies its leases run out and others take the tasks.
void RunWorker(const WorkerOptions& options, const std::stop_token& stop);

// Is `mortise-simulator --worker`: reads flags, handles signals and calls RunWorker. Returns the
// exit code.
int WorkerMain(int argc, char** argv);

}  // namespace mortise::simulator
