// Pieces of work one after another, with others' between.
#include "services/simulator/service/serial_executor.h"

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace mortise::simulator {
namespace {

TEST(SerialExecutor, RunsOnePieceAtATimeInOrder) {
  const auto dispatcher = rpc::Dispatcher::Create({.service = "probe", .threads = 4});
  SerialExecutor executor(dispatcher.get());
  std::atomic<int> running = 0;
  std::vector<int> order;
  for (int i = 0; i < 200; ++i) {
    executor.Submit([&, i] {
      EXPECT_EQ(++running, 1);
      order.push_back(i);
      std::this_thread::yield();
      --running;
    });
  }
  dispatcher->WaitIdle();
  ASSERT_EQ(order.size(), 200U);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(order[static_cast<std::size_t>(i)], i);
}

// However much waits, other work has a thread.
TEST(SerialExecutor, LeavesTheOtherThreads) {
  const auto dispatcher = rpc::Dispatcher::Create({.service = "probe", .threads = 2});
  SerialExecutor executor(dispatcher.get());
  std::mutex mutex;
  std::condition_variable changed;
  bool may_end = false, others_ran = false;
  for (int i = 0; i < 10; ++i) {
    executor.Submit([&] {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return may_end; });
    });
  }
  dispatcher->Submit([&] {
    const std::lock_guard lock(mutex);
    others_ran = may_end = true;
    changed.notify_all();
  });
  dispatcher->WaitIdle();
  EXPECT_TRUE(others_ran);
}

TEST(SerialExecutor, GoesOnAfterAPieceThatThrows) {
  const auto dispatcher = rpc::Dispatcher::Create({.service = "probe", .threads = 2});
  SerialExecutor executor(dispatcher.get());
  std::vector<int> ran;
  executor.Submit([] { throw std::runtime_error("a piece that fails"); });
  executor.Submit([&] {
    ran.push_back(1);
    executor.Submit([&] { ran.push_back(3); });
  });
  executor.Submit([&] { ran.push_back(2); });
  dispatcher->WaitIdle();
  EXPECT_EQ(ran.size(), 3U);
  EXPECT_EQ(ran.front(), 1);
}

}  // namespace
}  // namespace mortise::simulator
