#include "services/pareto/discovery/proposal_window.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "common/base/errors.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;
using Window = ProposalWindow<int>;

constexpr AnswerSizes kOneOfEach{.parameters = 1, .metrics = 1, .constraints = 0};

Evaluation AnswerTo(const VectorXd& x) {
  Evaluation evaluation;
  evaluation.x = x;
  evaluation.status = EvaluationStatus::kEvaluated;
  evaluation.metrics = x;
  return evaluation;
}

VectorXd Number(double value) { return VectorXd::Constant(1, value); }

// Proposes 0, 1, … `count` - 1, each with ten times its number as origin.
void ProposeSome(Window& window, int count) {
  for (int i = 0; i < count; ++i) window.Propose(Number(i), 10 * i);
}

TEST(ProposalWindowTest, CommitsInTheOrderOfNumbersWhateverTheOrderOfAnswers) {
  Window window(10, 4, kOneOfEach);
  ProposeSome(window, 3);
  std::vector<int> origins;
  const auto commit = [&](std::int64_t number, const Window::Proposed& proposed) {
    EXPECT_EQ(static_cast<double>(number), proposed.result->metrics[0]);
    origins.push_back(proposed.origin);
    return true;
  };
  ASSERT_TRUE(window.Tell(2, AnswerTo(Number(2))).ok());
  EXPECT_FALSE(window.CommitUpTo(1, commit)) << "the first result is missing";
  ASSERT_TRUE(window.Tell(0, AnswerTo(Number(0))).ok());
  EXPECT_TRUE(window.CommitUpTo(1, commit));
  EXPECT_FALSE(window.CommitUpTo(3, commit));
  ASSERT_TRUE(window.Tell(1, AnswerTo(Number(1))).ok());
  EXPECT_TRUE(window.CommitUpTo(3, commit));
  EXPECT_EQ(origins, (std::vector<int>{0, 10, 20}));
  EXPECT_EQ(window.committed(), 3);
  EXPECT_TRUE(window.under_way().empty());
}

TEST(ProposalWindowTest, NeedsWhatLeavesRoomForOneMoreAndAllAtABarrier) {
  Window window(10, 4, kOneOfEach);
  ProposeSome(window, 3);
  EXPECT_EQ(window.needed(), 0);
  EXPECT_EQ(window.room(), 1);
  window.Propose(Number(3), 30);
  EXPECT_EQ(window.needed(), 1);
  EXPECT_EQ(window.room(), 0);
  EXPECT_EQ(window.left(), 6);
  window.AwaitAll();
  EXPECT_EQ(window.needed(), 4);
}

TEST(ProposalWindowTest, StopsWhereACommitSaysSo) {
  Window window(10, 4, kOneOfEach);
  ProposeSome(window, 2);
  for (const int i : {0, 1}) ASSERT_TRUE(window.Tell(i, AnswerTo(Number(i))).ok());
  EXPECT_TRUE(window.CommitUpTo(2, [](std::int64_t, const Window::Proposed&) { return false; }));
  EXPECT_EQ(window.committed(), 1);
}

TEST(ProposalWindowTest, CommitsAllFromWithinACommit) {
  Window window(10, 4, kOneOfEach);
  ProposeSome(window, 3);
  for (const int i : {0, 1, 2}) ASSERT_TRUE(window.Tell(i, AnswerTo(Number(i))).ok());
  std::vector<std::int64_t> numbers;
  window.CommitUpTo(2, [&](std::int64_t number, const Window::Proposed&) {
    numbers.push_back(number);
    window.CommitUpTo(3, [&](std::int64_t inner, const Window::Proposed&) {
      numbers.push_back(inner);
      return true;
    });
    return true;
  });
  EXPECT_EQ(numbers, (std::vector<std::int64_t>{0, 1, 2}));
}

TEST(ProposalWindowTest, NamesWhatIsWrongWithAnAnswer) {
  Window window(10, 4, kOneOfEach);
  ProposeSome(window, 1);
  const auto field_of = [](const absl::Status& status) { return DetailOf(status).field; };
  EXPECT_EQ(field_of(window.Tell(1, AnswerTo(Number(0)))), "number");
  EXPECT_EQ(field_of(window.Tell(0, AnswerTo(Number(5)))), "x");
  Evaluation two = AnswerTo(Number(0));
  two.metrics = VectorXd::Zero(2);
  EXPECT_EQ(field_of(window.Tell(0, two)), "metrics");
  ASSERT_TRUE(window.Tell(0, AnswerTo(Number(0))).ok());
  EXPECT_EQ(field_of(window.Tell(0, AnswerTo(Number(0)))), "number") << "told twice";
}

}  // namespace
}  // namespace mortise::pareto
