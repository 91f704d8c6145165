// Searches that look at designs: what they find, and where they end.
#include "services/retrieval/filters/filtered_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "absl/status/status.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/index/random_covers.h"

namespace mortise::retrieval {
namespace {

using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

// Sixty families, and a query among them.
class FilteredSearchTest : public ::testing::Test {
 protected:
  static std::vector<int> FamiliesOf(const std::vector<IndexMatch>& matches) {
    std::vector<int> families;
    for (const IndexMatch& match : matches) families.push_back(match.family);
    return families;
  }

  // All families, nearest first.
  std::vector<int> All() const {
    IndexQuery query = Query(look_.families);
    return FamiliesOf(index_.Nearest(query).value());
  }

  IndexQuery Query(int count) const { return {.descriptors = {asked_}, .count = count}; }

  Random random_{5};
  const testing::CoverLook look_;
  const PrimitiveIndex index_ =
      PrimitiveIndex::Build(testing::RandomCovers(look_, &random_)).value();
  const Eigen::VectorXd asked_ = testing::RandomDescriptor(look_.dimension, &random_);
};

TEST_F(FilteredSearchTest, FindsWhatIsLeftOfTheListOfAll) {
  const auto is_third = [](int family) { return family % 3 == 1; };
  std::vector<int> expected;
  for (const int family : All()) {
    if (is_third(family)) expected.push_back(family);
  }
  ASSERT_EQ(expected.size(), 20u);
  std::vector<int> asked;
  const auto meets = [&](const IndexMatch& match) -> absl::StatusOr<bool> {
    asked.push_back(match.family);
    return is_third(match.family);
  };
  ASSERT_OK_AND_ASSIGN(const FilteredMatches all, NearestThatMeet(index_, Query(100), meets));
  EXPECT_THAT(FamiliesOf(all.matches), ElementsAreArray(expected));
  EXPECT_EQ(all.looked_at, look_.families);
  EXPECT_FALSE(all.ended_early);
  EXPECT_THAT(asked, ElementsAreArray(All())) << "each once, nearest first";

  ASSERT_OK_AND_ASSIGN(const FilteredMatches five, NearestThatMeet(index_, Query(5), meets));
  expected.resize(5);
  EXPECT_THAT(FamiliesOf(five.matches), ElementsAreArray(expected));
  EXPECT_LT(five.looked_at, look_.families) << "no more than it takes";
  EXPECT_FALSE(five.ended_early);
}

TEST_F(FilteredSearchTest, LooksAtNothingThatIsNotAllowed) {
  IndexQuery query = Query(100);
  query.allowed = [](int family) { return family < 7; };
  const auto meets = [](const IndexMatch&) -> absl::StatusOr<bool> { return true; };
  ASSERT_OK_AND_ASSIGN(const FilteredMatches found, NearestThatMeet(index_, query, meets));
  EXPECT_EQ(found.looked_at, 7);
  EXPECT_EQ(found.matches.size(), 7u);
}

TEST_F(FilteredSearchTest, AnswersWithWhatItHasOnceTheTimeIsUp) {
  int looked_at = 0;
  const auto meets = [&](const IndexMatch& match) -> absl::StatusOr<bool> {
    ++looked_at;
    return match.family % 2 == 0;
  };
  const FilterLimits limits{.is_time_up = [&] { return looked_at == 13; }};
  ASSERT_OK_AND_ASSIGN(const FilteredMatches found,
                       NearestThatMeet(index_, Query(60), meets, limits));
  std::vector<int> expected;
  for (int i = 0; i < 13; ++i) {
    if (const int family = All()[static_cast<std::size_t>(i)]; family % 2 == 0) {
      expected.push_back(family);
    }
  }
  EXPECT_THAT(FamiliesOf(found.matches), ElementsAreArray(expected));
  EXPECT_EQ(found.looked_at, 13);
  EXPECT_TRUE(found.ended_early);
}

TEST_F(FilteredSearchTest, EndsAfterSoManyDesigns) {
  const auto meets = [](const IndexMatch&) -> absl::StatusOr<bool> { return false; };
  ASSERT_OK_AND_ASSIGN(const FilteredMatches some,
                       NearestThatMeet(index_, Query(1), meets, {.designs = 30}));
  EXPECT_THAT(some.matches, IsEmpty());
  EXPECT_EQ(some.looked_at, 30);
  EXPECT_TRUE(some.ended_early);
  ASSERT_OK_AND_ASSIGN(const FilteredMatches all,
                       NearestThatMeet(index_, Query(1), meets, {.designs = 60}));
  EXPECT_EQ(all.looked_at, 60);
  EXPECT_FALSE(all.ended_early) << "there is no further one";
}

TEST_F(FilteredSearchTest, FailsAsWhatItAsksDoes) {
  const auto meets = [](const IndexMatch&) -> absl::StatusOr<bool> {
    return absl::CancelledError("gone");
  };
  EXPECT_TRUE(absl::IsCancelled(NearestThatMeet(index_, Query(1), meets).status()));
}

}  // namespace
}  // namespace mortise::retrieval
