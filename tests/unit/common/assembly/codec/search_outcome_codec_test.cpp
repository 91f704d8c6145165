// What searches came to, written and read again; what is not to be trusted is not read.
#include "common/assembly/codec/search_outcome_codec.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "absl/strings/str_replace.h"

namespace mortise::parametric {
namespace {

SearchOutcome Outcome() {
  SearchOutcome outcome;
  outcome.touching = {{0, 1}, {1, 4}};
  outcome.pattern_losses = {{2, 3}};
  outcome.repair_plan.lone = {2, 5};
  KnownConflicts& conflicts = outcome.repair_plan.known_conflicts;
  conflicts.kept_apart = {{"lid: \"open\"", 0, 3}};
  conflicts.kept_touching = {{"", 1, 2}};
  conflicts.fitted = {{"", 4, 5}, {"lid: zu", 4, 5}};
  conflicts.shares_kept = {{{3, Axis::kY}, 1}, {{3, Axis::kZ}, std::numeric_limits<int>::max()}};
  return outcome;
}

TEST(SearchOutcomeCodec, ReadsWhatItWrites) {
  const SearchOutcome outcome = Outcome();
  const auto read = SearchOutcomeFrom(ToText(outcome));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->touching, outcome.touching);
  EXPECT_EQ(read->pattern_losses, outcome.pattern_losses);
  EXPECT_EQ(read->repair_plan.lone, outcome.repair_plan.lone);
  EXPECT_EQ(read->repair_plan.known_conflicts.shares_kept,
            outcome.repair_plan.known_conflicts.shares_kept);
  EXPECT_EQ(ToText(*read), ToText(outcome));
  EXPECT_TRUE(SearchOutcomeFrom(ToText({})));
}

TEST(SearchOutcomeCodec, DoesNotReadOtherVersionsAndDamagedText) {
  const std::string text = ToText(Outcome());
  const std::string other = absl::StrReplaceAll(text, {{"\"version\":1", "\"version\":0"}});
  ASSERT_NE(other, text);
  EXPECT_FALSE(SearchOutcomeFrom(other));
  EXPECT_FALSE(SearchOutcomeFrom(""));
  EXPECT_FALSE(SearchOutcomeFrom("[]"));
  EXPECT_FALSE(SearchOutcomeFrom("{\"version\":1}"));
  EXPECT_FALSE(SearchOutcomeFrom("{\"version\":\"1\"}"));
  for (std::size_t length = 0; length < text.size(); ++length) {
    EXPECT_FALSE(SearchOutcomeFrom(std::string_view(text).substr(0, length))) << length;
  }
}

}  // namespace
}  // namespace mortise::parametric
