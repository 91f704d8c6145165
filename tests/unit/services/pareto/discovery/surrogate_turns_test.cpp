#include "services/pareto/discovery/surrogate_turns.h"

#include <gtest/gtest.h>

#include <optional>

namespace mortise::pareto {
namespace {

constexpr SurrogateQuality kGood{
    .proposals = 100, .predictions = 200, .within_two_deviations = 0.95};
constexpr SurrogateQuality kBad{.proposals = 100, .predictions = 200, .within_two_deviations = 0.5};

// The share of 1,000 proposals that the surrogate has where its evaluations gain `own` and those of
// others `other`.
double ShareOf(double own, double other, const SurrogateQuality& foretold,
               std::optional<double> fixed = std::nullopt) {
  SurrogateTurns turns(10, fixed);
  int count = 0;
  for (int k = 0; k < 1000; ++k) {
    const bool is_surrogates = turns.IsDue();
    count += is_surrogates ? 1 : 0;
    turns.Propose(is_surrogates, foretold);
    turns.Count(is_surrogates, is_surrogates ? own : other);
  }
  return count / 1000.0;
}

TEST(SurrogateTurnsTest, HasTwoOfFiveWhileItForetellsAndGains) {
  EXPECT_NEAR(ShareOf(1, 1, kGood), 0.4, 0.01);
  EXPECT_NEAR(ShareOf(5, 1, kGood), 0.4, 0.01);
  EXPECT_NEAR(ShareOf(0, 0, kGood), 0.4, 0.01);
}

TEST(SurrogateTurnsTest, HasTheFewerTheLessItGains) {
  const double half = ShareOf(1, 2, kGood);
  const double tenth = ShareOf(1, 10, kGood);
  EXPECT_LT(half, 0.3);
  EXPECT_LT(tenth, half);
  EXPECT_LT(ShareOf(0, 1, kGood), 0.2);
}

TEST(SurrogateTurnsTest, HasFewWhereItErrsThoughItGains) {
  EXPECT_NEAR(ShareOf(5, 1, kBad), 0.05, 0.01);
}

TEST(SurrogateTurnsTest, GetsTurnsBackWhenItHasLearnt) {
  SurrogateTurns turns(10, std::nullopt);
  for (int k = 0; k < 500; ++k) turns.Count(k % 2 == 0, k % 2 == 0 ? 0.0 : 1.0);
  EXPECT_LT(turns.Share(kGood), 0.1);
  for (int k = 0; k < 200; ++k) turns.Count(k % 2 == 0, k % 2 == 0 ? 1.0 : 0.1);
  EXPECT_NEAR(turns.Share(kGood), 0.4, 1e-12);
}

TEST(SurrogateTurnsTest, CountsAsTrustedBeforeItHasForetoldAnything) {
  EXPECT_NEAR(SurrogateTurns(10, std::nullopt).Share({}), 0.4, 1e-12);
}

TEST(SurrogateTurnsTest, KeepsAFixedShare) {
  EXPECT_NEAR(ShareOf(0, 1, kBad, 0.8), 0.8, 0.01);
  EXPECT_TRUE(SurrogateTurns(10, 0.8).IsFixed());
}

}  // namespace
}  // namespace mortise::pareto
