// Wakes a waiting thread.
#pragma once

#include <condition_variable>
#include <mutex>

#include "absl/time/time.h"

namespace mortise::operations {

// One thread waits, any thread rings; a ring is kept until the next wait.
class Bell {
 public:
  void Ring() {
    std::lock_guard lock(mutex_);
    rung_ = true;
    changed_.notify_one();
  }

  // Waits for a ring, at most so long.
  void Wait(absl::Duration timeout) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, absl::ToChronoNanoseconds(timeout), [this] { return rung_; });
    rung_ = false;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool rung_ = false;  // guarded by mutex_
};

}  // namespace mortise::operations
