// What a worker is told while it is at a task, and what is said of the task meanwhile.
#include "common/host/lease_keeper.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

namespace mortise::rpc {
namespace {

// How often something was said, for those who wait for it.
class Count {
 public:
  void Add() {
    const std::lock_guard lock(mutex_);
    ++count_;
    changed_.notify_all();
  }
  bool Reaches(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [&] { return count_ >= count; });
  }
  int value() const {
    const std::lock_guard lock(mutex_);
    return count_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int count_ = 0;
};

constexpr absl::Duration kShortLease = absl::Milliseconds(30);

// Whether the work hears that it is to stop.
bool HearsStop(const std::stop_token& token) {
  Count stopped;
  const std::stop_callback hearing(token, [&stopped] { stopped.Add(); });
  return stopped.Reaches(1);
}

TEST(LeaseKeeperTest, RenewsAsLongAsTheWorkGoesOn) {
  Count renewals, given_back;
  {
    const LeaseKeeper keeper({.lease = kShortLease},
                             {.renew =
                                  [&] {
                                    renewals.Add();
                                    return true;
                                  },
                              .give_back = [&] { given_back.Add(); }},
                             {});
    EXPECT_TRUE(renewals.Reaches(3));
    EXPECT_FALSE(keeper.lost());
    EXPECT_FALSE(keeper.stop_token().stop_requested());
  }
  EXPECT_EQ(given_back.value(), 0);
}

TEST(LeaseKeeperTest, StopsTheWorkWhenTheLeaseIsLost) {
  Count given_back;
  const LeaseKeeper keeper({.lease = kShortLease},
                           {.renew = [] { return false; }, .give_back = [&] { given_back.Add(); }},
                           {});
  EXPECT_TRUE(HearsStop(keeper.stop_token()));
  EXPECT_TRUE(keeper.lost());
  EXPECT_EQ(given_back.value(), 0) << "it is somebody else's";
}

TEST(LeaseKeeperTest, StopsTheWorkWhenItsTimeIsOverAndKeepsTheTask) {
  const LeaseKeeper keeper({.lease = kShortLease, .time_limit = absl::Milliseconds(1)},
                           {.renew = [] { return true; }, .give_back = [] {}}, {});
  EXPECT_TRUE(HearsStop(keeper.stop_token()));
  EXPECT_FALSE(keeper.lost()) << "its failure is still to be reported";
}

TEST(LeaseKeeperTest, GivesBackAfterTheDrainTime) {
  std::stop_source ending;
  Count given_back, reserve;
  const LeaseKeeper keeper({.lease = absl::Hours(1), .drain_time = absl::Milliseconds(1)},
                           {.renew = [] { return true; },
                            .give_back = [&] { given_back.Add(); },
                            .give_back_reserve = [&] { reserve.Add(); }},
                           ending.get_token());
  ending.request_stop();
  EXPECT_TRUE(given_back.Reaches(1));
  EXPECT_TRUE(keeper.lost());
  EXPECT_TRUE(keeper.stop_token().stop_requested());
}

TEST(LeaseKeeperTest, BreaksOffWorkThatDoesNotStop) {
  Count broken_off;
  const LeaseKeeper keeper({.lease = kShortLease, .break_off = [&] { broken_off.Add(); }},
                           {.renew = [] { return false; }, .give_back = [] {}}, {});
  EXPECT_TRUE(broken_off.Reaches(1));
}

}  // namespace
}  // namespace mortise::rpc
