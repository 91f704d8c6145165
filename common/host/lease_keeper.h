// Keeps the lease of a task while a worker is at it, and tells the work when to stop.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "absl/time/time.h"

namespace mortise::rpc {

// How long a worker may take, and how it ends.
struct LeaseTerms {
  absl::Duration lease = absl::Seconds(30);              // renewed while the work goes on
  absl::Duration time_limit = absl::InfiniteDuration();  // of one task
  absl::Duration drain_time = absl::Seconds(10);  // of the task at hand, once a stop is requested

  // Ends the process, or starts it anew, with all that it does now. Called where work that nobody
  // wants any more has not stopped within three seconds: what a library does in one call cannot be
  // stopped. Unset: the worker waits for it.
  std::function<void()> break_off = {};
};

// What is said of the task, and to whom. Called on a thread of the keeper's.
struct LeaseCalls {
  // Prolongs the lease; false once somebody has taken the task away. What cannot be asked now
  // counts as kept, and is logged by whoever asks.
  std::function<bool()> renew;
  // Says that this worker will not do the task: others may have it, unharmed.
  std::function<void()> give_back;
  // The same of tasks that were leased ahead and not begun; may be empty.
  std::function<void()> give_back_reserve = {};
};

// While it lives it renews the lease every third of its length, and at least every two seconds, so
// that a task which was cancelled is noticed soon. It asks for the work to stop once the lease is
// lost or the time is over. When the worker is asked to end, it gives the task back after the drain
// time, before the work has stopped, which may take long: the sooner others begin with it. What is
// in reserve it gives back when the task takes more than a second, or the worker is asked to end.
class LeaseKeeper {
 public:
  // `ending`: the worker is asked to end.
  LeaseKeeper(LeaseTerms terms, LeaseCalls calls, const std::stop_token& ending);
  ~LeaseKeeper();

  // For the work.
  std::stop_token stop_token() const { return stop_.get_token(); }

  // Whether the task was taken away or given back: its result is not wanted.
  bool lost() const { return lost_; }

 private:
  using Clock = std::chrono::steady_clock;

  void BeginDrain();
  void Run();
  void AwaitStop();
  void Drop();

  const LeaseTerms terms_;
  const LeaseCalls calls_;
  const Clock::duration interval_;
  std::stop_source stop_;
  std::atomic<bool> lost_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;                                          // guarded by mutex_
  Clock::time_point give_back_at_ = Clock::time_point::max();  // guarded by mutex_
  Clock::time_point empty_reserve_at_;                         // guarded by mutex_
  std::thread thread_;
  const std::stop_callback<std::function<void()>> ending_;  // last: gone before what it changes
};

}  // namespace mortise::rpc
