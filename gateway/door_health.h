// Whether the doors let clients in, as clients would find.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/status/status.h"

namespace mortise::gateway {

// Asks on a thread of its own, once a second, so that who asks for the health does not wait.
class DoorHealth {
 public:
  using Probe = std::function<absl::Status()>;

  ~DoorHealth() { End(); }

  // Once. The probes may block for some seconds; they must not be gone before End.
  void Begin(std::vector<Probe> probes);
  void End();

  // The first failure of the last round; OK before the first one. Thread safe.
  absl::Status Now() const;

 private:
  void Ask();

  std::vector<Probe> probes_;
  mutable std::mutex mutex_;
  std::condition_variable_any stopped_;
  absl::Status now_;  // guarded by mutex_
  std::jthread thread_;
};

}  // namespace mortise::gateway
