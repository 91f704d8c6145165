#include "common/base/thread_pool.h"

#include <gtest/gtest.h>

#include <atomic>

namespace mortise {
namespace {

TEST(ThreadPool, RunsEverythingSubmittedBeforeItEnds) {
  std::atomic<int> done = 0;
  {
    ThreadPool pool(4);
    for (int i = 0; i < 1000; ++i) pool.Submit([&done] { ++done; });
  }
  EXPECT_EQ(done, 1000);
}

TEST(ThreadPool, OneThreadKeepsTheOrder) {
  std::vector<int> order;
  {
    ThreadPool pool(1);
    for (int i = 0; i < 100; ++i) pool.Submit([&order, i] { order.push_back(i); });
  }
  for (int i = 0; i < 100; ++i) EXPECT_EQ(order[i], i);
}

TEST(ThreadPool, WorkMaySubmitWork) {
  std::atomic<int> done = 0;
  {
    ThreadPool pool(2);
    pool.Submit([&] { pool.Submit([&] { ++done; }); });
  }
  EXPECT_EQ(done, 1);
}

}  // namespace
}  // namespace mortise
