#include "common/fem/linear/thread_team.h"

#include <algorithm>

namespace mortise::simulator {
namespace {

// Fewer rows than this are not worth waking anybody for.
constexpr int kMinRange = 512;
constexpr int kRangesPerThread = 8;
constexpr int kSummands = 4096;

}  // namespace

ThreadTeam::ThreadTeam(int threads) {
  for (int k = 1; k < threads; ++k) threads_.emplace_back([this] { RunMember(); });
}

ThreadTeam::~ThreadTeam() {
  stopping_ = true;
  generation_.fetch_add(1);
  generation_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadTeam::RunMember() {
  int seen = 0;
  while (true) {
    generation_.wait(seen);
    seen = generation_.load();
    if (stopping_) return;
    Drain();
    if (pending_.fetch_sub(1) == 1) pending_.notify_one();
  }
}

void ThreadTeam::Drain() {
  for (int k = next_.fetch_add(1); k < count_; k = next_.fetch_add(1)) (*work_)(k);
}

void ThreadTeam::Run(int count, const std::function<void(int)>& work) {
  if (threads_.empty() || count <= 1) {
    for (int k = 0; k < count; ++k) work(k);
    return;
  }
  work_ = &work;
  count_ = count;
  next_ = 0;
  pending_ = static_cast<int>(threads_.size());
  generation_.fetch_add(1);
  generation_.notify_all();
  Drain();
  for (int left = pending_.load(); left != 0; left = pending_.load()) pending_.wait(left);
}

void ThreadTeam::ForRanges(int count, const std::function<void(int, int)>& work) {
  const int range = std::max(kMinRange, count / (kRangesPerThread * size()) + 1);
  Run((count + range - 1) / range,
      [&](int k) { work(k * range, std::min(count, (k + 1) * range)); });
}

double ThreadTeam::Sum(int count, const std::function<double(int, int)>& work) {
  std::vector<double> parts((count + kSummands - 1) / kSummands);
  Run(static_cast<int>(parts.size()),
      [&](int k) { parts[k] = work(k * kSummands, std::min(count, (k + 1) * kSummands)); });
  double sum = 0;
  for (const double part : parts) sum += part;
  return sum;
}

}  // namespace mortise::simulator
