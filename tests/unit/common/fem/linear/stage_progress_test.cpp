// How far a computation says that it is.
#include "common/fem/linear/stage_progress.h"

#include <gtest/gtest.h>

namespace mortise::simulator {
namespace {

TEST(StageProgress, NamesTheStageAndItsIteration) {
  StageProgress progress;
  EXPECT_EQ(progress.state().total, 0);
  EXPECT_EQ(progress.state().done, 0);
  progress.Expect(3);
  progress.Begin("mesh");
  EXPECT_EQ(progress.state().stage, "mesh");
  EXPECT_EQ(progress.state().done, 0);
  progress.Begin("solution");
  progress.Iterate(12);
  EXPECT_EQ(progress.state().stage, "solution: iteration 12");
  EXPECT_EQ(progress.state().done, 1);
}

TEST(StageProgress, IsNotAtItsEndWhileAStageRuns) {
  StageProgress progress;
  progress.Expect(2);
  for (int stage = 0; stage < 5; ++stage) {
    progress.Begin("one more than was expected");
    EXPECT_LT(progress.state().done, progress.state().total);
  }
}

TEST(StageProgress, TakesUpMoreWorkAndWhatItIsFor) {
  StageProgress progress;
  progress.Expect(2);
  progress.Begin("mesh");
  progress.Begin("solution");
  progress.Add(2);
  progress.Within("refining, step 1, error 31 %");
  progress.Begin("mesh");
  EXPECT_EQ(progress.state().stage, "refining, step 1, error 31 %: mesh");
  EXPECT_EQ(progress.state().done, 2);
  EXPECT_EQ(progress.state().total, 4);
  progress.Within("");
  progress.Begin("files");
  EXPECT_EQ(progress.state().stage, "files");
}

}  // namespace
}  // namespace mortise::simulator
