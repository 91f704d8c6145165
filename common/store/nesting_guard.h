// Refuses a transaction inside a transaction of the same thread, which would wait for itself.
#pragma once

#include <mutex>
#include <set>
#include <thread>

namespace mortise::store {

// The threads that are inside a transaction of one store.
class TransactingThreads {
 public:
  // Whether this thread entered; false if it is inside already.
  bool Enter() {
    std::lock_guard lock(mutex_);
    return threads_.insert(std::this_thread::get_id()).second;
  }

  void Leave() {
    std::lock_guard lock(mutex_);
    threads_.erase(std::this_thread::get_id());
  }

 private:
  std::mutex mutex_;
  std::set<std::thread::id> threads_;  // guarded by mutex_
};

// Enters while in scope.
class NestingGuard {
 public:
  explicit NestingGuard(TransactingThreads* threads)
      : threads_(threads), entered_(threads->Enter()) {}
  ~NestingGuard() { Leave(); }
  NestingGuard(const NestingGuard&) = delete;
  NestingGuard& operator=(const NestingGuard&) = delete;

  bool nested() const { return !entered_; }

  // Leaves before the end of the scope.
  void Leave() {
    if (entered_) threads_->Leave();
    entered_ = false;
  }

 private:
  TransactingThreads* threads_;
  bool entered_;
};

}  // namespace mortise::store
