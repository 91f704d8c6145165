// A few threads that share loops over the rows of matrices and vectors.
#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace mortise::simulator {

// The caller is one of the team. What a loop computes must not depend on who runs which part; then
// the result is the same to the bit for a team of any size.
class ThreadTeam {
 public:
  // The team has `threads` threads, the caller included; less than 1 counts as 1.
  explicit ThreadTeam(int threads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  int size() const { return static_cast<int>(threads_.size()) + 1; }

  // Calls work(k) for each k in 0 … count − 1, and returns when all are done. It must not throw.
  void Run(int count, const std::function<void(int)>& work);

  // Calls work(begin, end) for ranges that together cover 0 … count − 1.
  void ForRanges(int count, const std::function<void(int, int)>& work);

  // Returns the sum of work(begin, end) over ranges that depend on `count` only, added in order.
  double Sum(int count, const std::function<double(int, int)>& work);

 private:
  void RunMember();
  void Drain();

  const std::function<void(int)>* work_ = nullptr;
  int count_ = 0;
  std::atomic<int> next_{0};
  std::atomic<int> pending_{0};     // members that have not finished the present loop
  std::atomic<int> generation_{0};  // counts loops
  std::atomic<bool> stopping_{false};
  std::vector<std::thread> threads_;
};

}  // namespace mortise::simulator
