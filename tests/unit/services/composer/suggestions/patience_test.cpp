// Trials end in time to tell of them.
#include "services/composer/suggestions/patience.h"

#include <gtest/gtest.h>

namespace mortise::composer {
namespace {

class PatienceTest : public ::testing::Test {
 protected:
  Patience Until(absl::Duration left) {
    return Patience(now_ + left, [this] { return now_; });
  }
  void Try(Patience& patience, absl::Duration takes) {
    patience.Try([&] { now_ += takes; });
  }

  absl::Time now_ = absl::UnixEpoch();
};

TEST_F(PatienceTest, WithoutADeadlineThereIsAlwaysTime) {
  Patience endless(absl::InfiniteFuture(), [this] { return now_; });
  Try(endless, absl::Hours(100));
  EXPECT_TRUE(endless.HasTimeForTrial());
  EXPECT_FALSE(endless.IsOver());
}

TEST_F(PatienceTest, ATrialIsBegunThatCanEndInTime) {
  Patience patience = Until(absl::Seconds(10));  // 9 of them for trials
  EXPECT_TRUE(patience.HasTimeForTrial());
  Try(patience, absl::Seconds(3));
  EXPECT_TRUE(patience.HasTimeForTrial());
  Try(patience, absl::Seconds(1));
  EXPECT_TRUE(patience.HasTimeForTrial());
  Try(patience, absl::Seconds(2));
  EXPECT_FALSE(patience.HasTimeForTrial());  // 3 are left, of which none may be lost
  EXPECT_FALSE(patience.IsOver());
  now_ += absl::Seconds(3);
  EXPECT_TRUE(patience.IsOver());
}

TEST_F(PatienceTest, OfLittleTimeNoneIsForTrials) {
  for (const absl::Duration left :
       {absl::Milliseconds(40), absl::ZeroDuration(), absl::Seconds(-1)}) {
    EXPECT_FALSE(Until(left).HasTimeForTrial()) << left;
    EXPECT_TRUE(Until(left).IsOver()) << left;
  }
  EXPECT_TRUE(Until(absl::Milliseconds(60)).HasTimeForTrial());
}

}  // namespace
}  // namespace mortise::composer
