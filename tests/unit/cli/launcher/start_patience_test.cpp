#include "cli/launcher/start_patience.h"

#include <gtest/gtest.h>

namespace mortise::cli {
namespace {

using std::chrono::seconds;
using Verdict = StartPatience::Verdict;

class StartPatienceTest : public ::testing::Test {
 protected:
  Verdict After(int passed, int progress) {
    return patience_.Look(begin_ + seconds(passed), progress);
  }

  StartPatience::Clock::time_point begin_;
  StartPatience patience_{begin_};
};

TEST_F(StartPatienceTest, WaitsAndTellsEveryMinuteWhileProcessesGetOn) {
  EXPECT_EQ(After(1, 1), Verdict::kWait);
  EXPECT_EQ(After(59, 2), Verdict::kWait);
  EXPECT_EQ(After(60, 3), Verdict::kTell);
  EXPECT_EQ(After(61, 4), Verdict::kWait);
  EXPECT_EQ(After(119, 4), Verdict::kWait);
  EXPECT_EQ(After(120, 5), Verdict::kTell);
}

TEST_F(StartPatienceTest, GivesUpWhereNothingMovesForAMinute) {
  EXPECT_EQ(After(10, 7), Verdict::kWait);
  EXPECT_EQ(After(69, 7), Verdict::kTell);
  EXPECT_EQ(After(70, 7), Verdict::kGiveUp);
}

TEST_F(StartPatienceTest, GivesUpAfterFiveMinutesWhateverMoves) {
  for (int passed = 1; passed < 300; ++passed) {
    ASSERT_NE(After(passed, passed), Verdict::kGiveUp) << passed;
  }
  EXPECT_EQ(After(300, 300), Verdict::kGiveUp);
}

}  // namespace
}  // namespace mortise::cli
