#include "common/cad/forked_attempt.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

namespace mortise::cad {
namespace {

AttemptEnd Attempt(const std::function<bool()>& work, int seconds = 20) {
  const auto end = AttemptInCopy(work, std::chrono::seconds(seconds));
  EXPECT_TRUE(end.ok()) << end.status();
  return end.value_or(AttemptEnd::kCrashed);
}

TEST(ForkedAttempt, SaysWhetherTheWorkCouldBeDone) {
  EXPECT_EQ(Attempt([] { return true; }), AttemptEnd::kDone);
  EXPECT_EQ(Attempt([] { return false; }), AttemptEnd::kRefused);
  EXPECT_EQ(Attempt([]() -> bool { throw std::runtime_error("no"); }), AttemptEnd::kRefused);
}

TEST(ForkedAttempt, OutlivesWorkThatEndsItsProcess) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE}) {
    EXPECT_EQ(Attempt([signal] {
                ::raise(signal);
                return true;
              }),
              AttemptEnd::kCrashed)
        << signal;
  }
  EXPECT_EQ(Attempt([]() -> bool { std::_Exit(0); }), AttemptEnd::kCrashed);
}

TEST(ForkedAttempt, EndsWorkThatComesToNoEnd) {
  std::atomic<unsigned> turns = 0;
  const auto work = [&turns] {
    while (++turns > 0 || turns == 0) {
    }
    return true;
  };
  EXPECT_EQ(Attempt(work, 1), AttemptEnd::kOutOfTime);
}

TEST(ForkedAttempt, LosesWhatTheWorkChanges) {
  std::vector<int> numbers = {1, 2};
  EXPECT_EQ(Attempt([&] {
              numbers.push_back(3);
              std::puts("nobody reads this");
              return numbers.size() == 3;
            }),
            AttemptEnd::kDone);
  EXPECT_EQ(numbers.size(), 2U);
}

TEST(ForkedAttempt, RunsInManyThreadsAtOnce) {
  std::atomic<int> right = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&right, t] {
      for (int i = 0; i < 10; ++i) {
        const bool crashes = (t + i) % 2 == 0;
        const AttemptEnd end = Attempt([crashes] {
          if (crashes) ::raise(SIGSEGV);
          return std::vector<int>(1000, 1).size() == 1000;
        });
        if (end == (crashes ? AttemptEnd::kCrashed : AttemptEnd::kDone)) ++right;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, 80);
}

}  // namespace
}  // namespace mortise::cad
