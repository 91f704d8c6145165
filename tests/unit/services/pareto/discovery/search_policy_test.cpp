#include "services/pareto/discovery/search_policy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mortise::pareto {
namespace {

DiscoveryOptions WithBudget(std::int64_t evaluations) {
  DiscoveryOptions options;
  options.evaluations = evaluations;
  return options;
}

TEST(SearchPolicyTest, FillsSpaceWithAFewMoreThanParametersAndAQuarterAtMost) {
  EXPECT_EQ(SearchPolicy(WithBudget(1000), 10, 2).InitialSamples(), 13);
  EXPECT_EQ(SearchPolicy(WithBudget(20), 10, 2).InitialSamples(), 5);
  EXPECT_EQ(SearchPolicy(WithBudget(1), 10, 2).InitialSamples(), 1);
  DiscoveryOptions options = WithBudget(1000);
  options.constraints = 2;
  EXPECT_EQ(SearchPolicy(options, 10, 2).InitialSamples(), 33);
  options.initial_samples = 7;
  options.initial_designs = Eigen::MatrixXd::Zero(10, 5);
  EXPECT_EQ(SearchPolicy(options, 10, 2).InitialSamples(), 12);
}

TEST(SearchPolicyTest, SpacingFallsWithTheBudgetWithinItsLimits) {
  const SearchPolicy policy(WithBudget(1000), 10, 2);
  EXPECT_DOUBLE_EQ(policy.SpacingFor(600), 0.01);
  EXPECT_EQ(policy.SpacingFor(1'000'000), 0.005);
  EXPECT_EQ(policy.SpacingFor(6), 0.15);
  EXPECT_EQ(SearchPolicy(WithBudget(1000), 10, 5).SpacingFor(6), 0.5);
  EXPECT_GT(SearchPolicy(WithBudget(1000), 10, 3).SpacingFor(600), policy.SpacingFor(600));
}

TEST(SearchPolicyTest, LargerBudgetsAllowForMore) {
  EXPECT_FALSE(SearchPolicy(WithBudget(299), 10, 2).Explores());
  EXPECT_TRUE(SearchPolicy(WithBudget(300), 10, 2).Explores());
  EXPECT_FALSE(SearchPolicy(WithBudget(999), 10, 2).Evolves());
  EXPECT_TRUE(SearchPolicy(WithBudget(1000), 10, 2).Evolves());
  EXPECT_FALSE(SearchPolicy(WithBudget(4999), 10, 2).Finishing().is_ample);
  EXPECT_TRUE(SearchPolicy(WithBudget(5000), 10, 2).Finishing().is_ample);
  EXPECT_FALSE(SearchPolicy(WithBudget(5000), 10, 3).Finishing().is_ample);
}

TEST(SearchPolicyTest, SurrogateIsForTheFirstThousandEvaluationsWithoutGradients) {
  const SearchPolicy policy(WithBudget(100'000), 40, 2);
  EXPECT_TRUE(policy.UsesSurrogate(false, 50));
  EXPECT_TRUE(policy.UsesSurrogate(false, 999));
  EXPECT_FALSE(policy.UsesSurrogate(false, 1000));
  EXPECT_FALSE(policy.UsesSurrogate(true, 50));
  EXPECT_FALSE(SearchPolicy(WithBudget(100), 41, 2).UsesSurrogate(false, 50));
  EXPECT_FALSE(policy.FixedSurrogateShare());
  DiscoveryOptions options = WithBudget(100'000);
  options.surrogate = DiscoveryOptions::Surrogate::kAlways;
  EXPECT_TRUE(SearchPolicy(options, 41, 2).UsesSurrogate(true, 5000));
  EXPECT_TRUE(SearchPolicy(options, 41, 2).FixedSurrogateShare());
  options.surrogate = DiscoveryOptions::Surrogate::kNever;
  EXPECT_FALSE(SearchPolicy(options, 2, 2).UsesSurrogate(false, 0));
}

TEST(SearchPolicyTest, PatienceEndsFirstForPiecesAndThenForAll) {
  using Patience = SearchPolicy::Patience;
  const SearchPolicy policy(WithBudget(1000), 10, 2);
  EXPECT_EQ(policy.PatienceAfter(77), Patience::kAll);
  EXPECT_EQ(policy.PatienceAfter(78), Patience::kOptimizations);
  EXPECT_EQ(policy.PatienceAfter(260), Patience::kNone);
  EXPECT_EQ(SearchPolicy(WithBudget(1000), 10, 3).PatienceAfter(259), Patience::kAll);
}

TEST(SearchPolicyTest, CellsOfTheBufferAreFewerWithMoreMetrics) {
  EXPECT_EQ(BufferOptions(WithBudget(1000), 2).cells_per_angle, 1000);
  EXPECT_EQ(BufferOptions(WithBudget(1000), 3).cells_per_angle, 100);
  EXPECT_EQ(BufferOptions(WithBudget(1000), 4).cells_per_angle, 64);
  EXPECT_EQ(BufferOptions(WithBudget(1000), 4).cell_limit, 250u);
  DiscoveryOptions options = WithBudget(1000);
  options.cells_per_angle = 10'000;
  EXPECT_EQ(BufferOptions(options, 2).cells_per_angle, 10'000);
  EXPECT_LE(std::pow(BufferOptions(options, 6).cells_per_angle, 5), 2e9);
}

}  // namespace
}  // namespace mortise::pareto
