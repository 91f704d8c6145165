#include "tests/unit/services/composer/scripts/random_script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_join.h"

namespace mortise::composer {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kScripts = 30;

TEST(RandomScriptTest, LeavesAModelThatCanBeBuiltAfterEveryStep) {
  int connected = 0, dragged = 0, held = 0;
  for (std::uint64_t seed = 1; seed <= kScripts; ++seed) {
    ScriptOutcome outcome = RunRandomScript({.seed = seed, .steps = 12, .most_parts = 130});
    EXPECT_THAT(outcome.violations, IsEmpty()) << "seed " << seed << ":\n"
                                               << absl::StrJoin(outcome.steps, "\n");
    for (const auto& [refused, count] : outcome.refused) {
      EXPECT_THAT(refused, Not(HasSubstr("FEASIBLE_SET_UNBOUNDED"))) << "seed " << seed;
    }
    connected += outcome.done["connect"];
    dragged += outcome.done["drag"];
    held += outcome.made_connections;
  }
  EXPECT_GT(connected, kScripts / 5);
  EXPECT_GT(dragged, kScripts / 5);
  EXPECT_GT(held, kScripts / 5);
}

// Room for a later connection moved the screws of an earlier one into others.
TEST(RandomScriptTest, KeepsTheScrewsOfEarlierConnectionsApart) {
  EXPECT_THAT(RunRandomScript({.seed = 1458, .steps = 14, .most_parts = 130}).violations,
              IsEmpty());
}

TEST(RandomScriptTest, IsTheSameAgain) {
  const ScriptOutcome once = RunRandomScript({.seed = 7, .steps = 8, .most_parts = 130});
  EXPECT_EQ(RunRandomScript({.seed = 7, .steps = 8, .most_parts = 130}).steps, once.steps);
}

}  // namespace
}  // namespace mortise::composer
