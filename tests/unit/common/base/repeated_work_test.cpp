#include "common/base/repeated_work.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

namespace mortise {
namespace {

TEST(RepeatedWork, IsDoneAtOnceAndAgain) {
  std::mutex mutex;
  std::condition_variable done;
  int times = 0;
  {
    const RepeatedWork work(std::chrono::milliseconds(1), [&] {
      const std::lock_guard lock(mutex);
      ++times;
      done.notify_all();
    });
    std::unique_lock lock(mutex);
    done.wait(lock, [&] { return times >= 3; });
  }
  const int at_end = times;
  EXPECT_GE(at_end, 3);
}

TEST(RepeatedWork, EndsWithoutWaitingForItsPause) {
  std::mutex mutex;
  std::condition_variable done;
  bool is_done = false;
  const auto begin = std::chrono::steady_clock::now();
  {
    const RepeatedWork work(std::chrono::hours(24), [&] {
      const std::lock_guard lock(mutex);
      is_done = true;
      done.notify_all();
    });
    std::unique_lock lock(mutex);
    done.wait(lock, [&] { return is_done; });
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::hours(1));
}

}  // namespace
}  // namespace mortise
