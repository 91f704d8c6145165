// One thread makes what many ask for; what is kept stays within its bytes; failures are told to all
// and not kept.
#include "common/base/single_flight_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace mortise {
namespace {

using Cache = SingleFlightCache<std::shared_ptr<const std::string>>;

Cache::Made Text(const std::string& text, std::size_t bytes) {
  return {std::make_shared<const std::string>(text), bytes};
}

std::string TextOf(Cache& cache, const std::string& key) {
  const auto found = cache.Find(key);
  return found ? **found : "";
}

// Asks for `key` on several threads at once; the first call of `make` goes on when all others wait.
std::vector<absl::Status> AskTogether(Cache& cache, std::size_t threads,
                                      const std::function<absl::StatusOr<Cache::Made>(int)>& make,
                                      std::atomic<int>& made) {
  std::vector<absl::Status> statuses(threads);
  std::vector<std::thread> asking;
  for (std::size_t i = 0; i < threads; ++i) {
    asking.emplace_back([&, i] {
      statuses[i] = cache
                        .Get("key",
                             [&]() -> absl::StatusOr<Cache::Made> {
                               const int call = ++made;
                               while (call == 1 && cache.waiting() + 1 < threads) {
                                 std::this_thread::yield();
                               }
                               return make(call);
                             })
                        .status();
    });
  }
  for (std::thread& thread : asking) thread.join();
  return statuses;
}

TEST(SingleFlightCache, MakesOnceWhatManyAskFor) {
  Cache cache(100);
  std::atomic<int> made = 0;
  for (const absl::Status& status : AskTogether(
           cache, 8, [](int) { return Text("value", 10); }, made)) {
    EXPECT_TRUE(status.ok()) << status;
  }
  EXPECT_EQ(made, 1);
  EXPECT_EQ(TextOf(cache, "key"), "value");
}

TEST(SingleFlightCache, TellsAFailureToAllThatWaitAndDoesNotKeepIt) {
  Cache cache(100);
  std::atomic<int> made = 0;
  for (const absl::Status& status : AskTogether(
           cache, 8, [](int) { return absl::NotFoundError("gone"); }, made)) {
    EXPECT_TRUE(absl::IsNotFound(status)) << status;
  }
  EXPECT_EQ(made, 1);
  EXPECT_TRUE(cache.Get("key", [] { return Text("there", 1); }).ok());
  EXPECT_EQ(TextOf(cache, "key"), "there");
}

TEST(SingleFlightCache, OneCallersDeadlineIsNotThatOfTheOthers) {
  Cache cache(100);
  std::atomic<int> made = 0;
  const auto make = [](int call) -> absl::StatusOr<Cache::Made> {
    if (call == 1) return absl::DeadlineExceededError("too late");
    return Text("value", 10);
  };
  int late = 0;
  for (const absl::Status& status : AskTogether(cache, 8, make, made)) {
    if (!status.ok()) ++late;
  }
  EXPECT_EQ(late, 1);
  EXPECT_EQ(made, 2);
}

TEST(SingleFlightCache, OversizedValuesReachAllThatWait) {
  Cache cache(5);
  std::atomic<int> made = 0;
  for (const absl::Status& status : AskTogether(
           cache, 8, [](int) { return Text("value", 10); }, made)) {
    EXPECT_TRUE(status.ok()) << status;
  }
  EXPECT_EQ(made, 1);
  EXPECT_EQ(cache.bytes(), 0u);
}

TEST(SingleFlightCache, MakingDoesNotHoldUpOthers) {
  Cache cache(100);
  ASSERT_TRUE(cache
                  .Get("outer",
                       [&]() -> absl::StatusOr<Cache::Made> {
                         std::thread other([&] {
                           EXPECT_TRUE(cache.Get("other", [] { return Text("b", 1); }).ok());
                         });
                         other.join();
                         return Text("a", 1);
                       })
                  .ok());
  EXPECT_EQ(TextOf(cache, "outer") + TextOf(cache, "other"), "ab");
}

TEST(SingleFlightCache, ForgetsWhatWasNotUsedForLongest) {
  Cache cache(100);
  for (const char* key : {"a", "b", "c"}) {
    ASSERT_TRUE(cache.Get(key, [&] { return Text(key, 30); }).ok());
  }
  EXPECT_EQ(TextOf(cache, "a"), "a");  // used again
  ASSERT_TRUE(cache.Get("d", [] { return Text("d", 40); }).ok());
  EXPECT_EQ(TextOf(cache, "b"), "");
  EXPECT_EQ(TextOf(cache, "a") + TextOf(cache, "c") + TextOf(cache, "d"), "acd");
  EXPECT_EQ(cache.bytes(), 100u);
  ASSERT_TRUE(cache.Get("e", [] { return Text("e", 100); }).ok());
  EXPECT_EQ(TextOf(cache, "a") + TextOf(cache, "c") + TextOf(cache, "d"), "");
  EXPECT_EQ(cache.bytes(), 100u);
}

TEST(SingleFlightCache, AnOversizedValueIsForgottenOrKeptAlone) {
  Cache forgetful(10), keen(10, Oversize::kAlone);
  for (Cache* cache : {&forgetful, &keen}) {
    ASSERT_TRUE(cache->Get("small", [] { return Text("small", 4); }).ok());
    ASSERT_TRUE(cache->Get("large", [] { return Text("large", 50); }).ok());
  }
  EXPECT_EQ(TextOf(forgetful, "small"), "small");
  EXPECT_EQ(TextOf(forgetful, "large"), "");
  EXPECT_EQ(TextOf(keen, "small"), "");
  EXPECT_EQ(TextOf(keen, "large"), "large");
  ASSERT_TRUE(keen.Get("next", [] { return Text("next", 4); }).ok());
  EXPECT_EQ(TextOf(keen, "large"), "");
  EXPECT_EQ(keen.bytes(), 4u);
}

TEST(SingleFlightCache, AnExceptionLeavesNobodyWaiting) {
  Cache cache(10);
  EXPECT_THROW(
      cache.Get("key", []() -> absl::StatusOr<Cache::Made> { throw std::runtime_error("no"); })
          .IgnoreError(),
      std::runtime_error);
  EXPECT_TRUE(cache.Get("key", [] { return Text("value", 1); }).ok());
}

}  // namespace
}  // namespace mortise
