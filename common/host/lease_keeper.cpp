#include "common/host/lease_keeper.h"

#include <algorithm>
#include <utility>

#include "common/base/logging.h"

namespace mortise::rpc {
namespace {

using Clock = std::chrono::steady_clock;

// How soon a worker notices that a task was cancelled, and tells how far it is.
constexpr absl::Duration kLookForCancel = absl::Seconds(2);

// How long work may take to stop that nobody wants any more.
constexpr absl::Duration kTimeToStop = absl::Seconds(3);

// How long what was leased ahead waits behind a task that takes longer than was thought.
constexpr absl::Duration kReservePatience = absl::Seconds(1);

Clock::time_point After(absl::Duration duration) {
  if (duration > absl::Hours(24 * 365)) return Clock::time_point::max();
  return Clock::now() + absl::ToChronoNanoseconds(duration);
}

}  // namespace

LeaseKeeper::LeaseKeeper(LeaseTerms terms, LeaseCalls calls, const std::stop_token& ending)
    : terms_(std::move(terms)),
      calls_(std::move(calls)),
      interval_(absl::ToChronoNanoseconds(std::min(terms_.lease / 3, kLookForCancel))),
      empty_reserve_at_(calls_.give_back_reserve ? After(kReservePatience)
                                                 : Clock::time_point::max()),
      thread_([this] { Run(); }),
      ending_(ending, [this] { BeginDrain(); }) {}

LeaseKeeper::~LeaseKeeper() {
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LeaseKeeper::BeginDrain() {
  {
    const std::lock_guard lock(mutex_);
    give_back_at_ = After(terms_.drain_time);
    if (calls_.give_back_reserve) empty_reserve_at_ = Clock::now();
  }
  changed_.notify_all();
}

void LeaseKeeper::Run() {
  const Clock::time_point end = After(terms_.time_limit);
  Clock::time_point renewal = Clock::now() + interval_;
  std::unique_lock lock(mutex_);
  while (!done_) {
    const Clock::time_point now = Clock::now();
    if (now >= give_back_at_) {
      lock.unlock();
      Drop();
      calls_.give_back();
      return AwaitStop();
    }
    if (now >= empty_reserve_at_) {
      empty_reserve_at_ = Clock::time_point::max();
      lock.unlock();
      calls_.give_back_reserve();
      lock.lock();
      continue;
    }
    if (now < renewal) {
      changed_.wait_until(lock, std::min({renewal, give_back_at_, empty_reserve_at_}));
      continue;
    }
    lock.unlock();
    if (now > end) stop_.request_stop();
    if (!calls_.renew()) {
      Drop();
      return AwaitStop();
    }
    renewal = Clock::now() + interval_;
    lock.lock();
  }
}

// After the task was lost: work that does not stop by itself is broken off.
void LeaseKeeper::AwaitStop() {
  std::unique_lock lock(mutex_);
  const bool stopped =
      changed_.wait_for(lock, absl::ToChronoNanoseconds(kTimeToStop), [this] { return done_; });
  if (stopped || !terms_.break_off) return;
  Log(LogLevel::kInfo, "breaking off, as a dropped task does not stop", {});
  terms_.break_off();
}

void LeaseKeeper::Drop() {
  lost_ = true;
  stop_.request_stop();
}

}  // namespace mortise::rpc
