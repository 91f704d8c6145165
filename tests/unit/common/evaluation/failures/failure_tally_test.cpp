// Why designs failed: what counts as alike, and what is told of it.
#include "common/evaluation/failures/failure_tally.h"

#include <gtest/gtest.h>

namespace mortise::evaluation {
namespace {

FailedDesign Failed(const std::string& reason, const std::string& message, double x = 0) {
  return {reason, absl::StatusCode::kFailedPrecondition, message, Eigen::VectorXd::Constant(1, x)};
}

TEST(FailureTallyTest, CountsWhatDiffersInNumbersOnlyAsAlike) {
  FailureTally tally;
  tally.Add(Failed("TOO_THIN", "the wall is 0.0012 m", 1));
  tally.Add(Failed("TOO_THIN", "the wall is -3.5e-05 m", 2));
  tally.Add(Failed("TOO_THIN", "the wall is 7 m", 3));
  tally.Add(Failed("TOO_THIN", "the floor is 7 m", 4));
  tally.Add(Failed("OPEN", "the wall is 7 m", 5));
  ASSERT_EQ(tally.failures().size(), 3u);
  EXPECT_EQ(tally.failures()[0].count, 3);
  EXPECT_EQ(tally.failures()[0].message, "the wall is 0.0012 m");
  EXPECT_EQ(tally.failures()[0].x[0], 1);
  EXPECT_FALSE(tally.failures()[0].same_message);
  EXPECT_TRUE(tally.failures()[1].same_message);
  EXPECT_EQ(CountsByReason(tally.failures()), "4 TOO_THIN, 1 OPEN");
  EXPECT_EQ(CountsWithExamples(tally.failures()),
            "3 TOO_THIN, such as: the wall is 0.0012 m; 1 TOO_THIN, such as: the floor is 7 m; "
            "1 OPEN, such as: the wall is 7 m");
}

TEST(FailureTallyTest, NamesTheCodeWhereThereIsNoReason) {
  FailureTally tally;
  tally.Add(Failed("", "cannot be built"));
  EXPECT_EQ(CountsByReason(tally.failures()), "1 FAILED_PRECONDITION");
}

TEST(FailureTallyTest, StaysSmallAndCountsEverything) {
  FailureTally tally;
  for (int i = 0; i < 1000; ++i) tally.Add(Failed("R", std::string(1 + i % 50, 'x')));
  EXPECT_EQ(tally.failures().size(), 16u);
  EXPECT_EQ(tally.failures().back().reason, "OTHER");
  std::int64_t count = 0;
  for (const FailureCount& failure : tally.failures()) count += failure.count;
  EXPECT_EQ(count, 1000);
}

TEST(FailureTallyTest, TellsWhatASubjectMayLackFromWhatDesignsLack) {
  FailureTally tally;
  for (int i = 0; i < 2; ++i) {
    tally.Add(Failed("NO_SUPPORT", "nothing holds it"));
    tally.Add(Failed("RIGID_MOTION", "it can turn"));
    tally.Add({"FIELD_INVALID", absl::StatusCode::kInvalidArgument, "too thin", {}});
  }
  tally.Add(Failed("NO_LOAD", "nothing loads it"));
  ASSERT_EQ(tally.failures().size(), 4u);
  EXPECT_TRUE(MayBeOfSubject(tally.failures()[0]));
  for (std::size_t i = 1; i < 4; ++i) EXPECT_FALSE(MayBeOfSubject(tally.failures()[i])) << i;
}

}  // namespace
}  // namespace mortise::evaluation
