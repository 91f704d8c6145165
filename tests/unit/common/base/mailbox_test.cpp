// What is put by some threads and taken by one.
#include "common/base/mailbox.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

namespace mortise {
namespace {

using std::chrono::milliseconds;

TEST(MailboxTest, GivesThingsInTheirOrder) {
  Mailbox<std::unique_ptr<int>> mailbox;
  EXPECT_FALSE(mailbox.Take(milliseconds(0)));
  mailbox.Put(std::make_unique<int>(1));
  mailbox.Put(std::make_unique<int>(2));
  EXPECT_EQ(**mailbox.Take(milliseconds(0)), 1);
  EXPECT_EQ(**mailbox.Take(milliseconds(0)), 2);
  EXPECT_FALSE(mailbox.Take(milliseconds(0)));
}

TEST(MailboxTest, WaitsForThoseThatPut) {
  constexpr int kThreads = 4, kEach = 100;
  Mailbox<int> mailbox;
  std::vector<std::jthread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&mailbox] {
      for (int i = 0; i < kEach; ++i) mailbox.Put(i);
    });
  }
  int sum = 0;
  for (int i = 0; i < kThreads * kEach; ++i) sum += mailbox.Take(milliseconds(60'000)).value_or(-1);
  EXPECT_EQ(sum, kThreads * kEach * (kEach - 1) / 2);
}

}  // namespace
}  // namespace mortise
