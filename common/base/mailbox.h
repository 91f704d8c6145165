// What some threads finish, for one that waits for it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace mortise {

// Thread safe. Gives things in the order in which they were put.
template <typename Thing>
class Mailbox {
 public:
  void Put(Thing thing) {
    const std::lock_guard lock(mutex_);
    things_.push_back(std::move(thing));
    arrived_.notify_one();
  }

  // Waits for a thing; nothing if none arrives within `patience`.
  std::optional<Thing> Take(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    if (!arrived_.wait_for(lock, patience, [&] { return !things_.empty(); })) return std::nullopt;
    Thing thing = std::move(things_.front());
    things_.pop_front();
    return thing;
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Thing> things_;  // guarded by mutex_
};

}  // namespace mortise
