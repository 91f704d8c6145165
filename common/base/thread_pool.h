// A fixed number of threads that run submitted work in order of arrival.
//
// gRPC's callback threads must never compute or block: service adapters hand their work to a pool.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace mortise {

class ThreadPool {
 public:
  explicit ThreadPool(int threads);

  // Runs what was submitted, then joins.
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  // Queues `work`. It must not throw.
  void Submit(std::function<void()> work);

 private:
  void RunWorker();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> queue_;  // guarded by mutex_
  bool stopping_ = false;                    // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace mortise
