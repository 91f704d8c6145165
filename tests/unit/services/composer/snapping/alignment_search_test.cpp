// Branch and bound finds what looking at all combinations finds.
#include "services/composer/snapping/alignment_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "services/composer/model/placed_forms.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

// Choices of places for faces of random parts, around where they are.
std::vector<ChoiceOfPlanes> RandomChoices(const Design& design, std::mt19937_64& random) {
  const std::vector<PrincipalPart> parts = PrincipalPartsOf(design);
  std::uniform_int_distribution<std::size_t> any_part(0, parts.size() - 1);
  std::uniform_int_distribution<int> any_axis(0, 2), count(1, 4);
  std::normal_distribution<double> off(0, 0.1);
  std::vector<ChoiceOfPlanes> choices;
  for (int i = 0; i < 4; ++i) {
    const PrincipalPart& part = parts[any_part(random)];
    ChoiceOfPlanes& choice = choices.emplace_back();
    choice.form = FaceOf(part, static_cast<Axis>(any_axis(random)), (random() & 1) != 0);
    const double now = choice.form.At(InSpace(design));
    for (int k = count(random); k > 0; --k) choice.values.push_back(now + off(random));
  }
  return choices;
}

class AlignmentSearchTest : public ::testing::TestWithParam<std::string> {};

TEST_P(AlignmentSearchTest, PruningChangesNothingButTheWork) {
  const Design& design = ShippedDesign(GetParam());
  const MovableSet set(*design.assembly);
  std::mt19937_64 random(17);
  int found = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const std::vector<ChoiceOfPlanes> choices = RandomChoices(design, random);
    ASSERT_OK_AND_ASSIGN(const auto quick, ChoosePlanes(set, InSpace(design), choices));
    ASSERT_OK_AND_ASSIGN(const auto all, EnumeratePlanes(set, InSpace(design), choices));
    ASSERT_EQ(quick.has_value(), all.has_value());
    if (!quick) continue;
    ++found;
    EXPECT_EQ(quick->values, all->values);
    EXPECT_NEAR(quick->cost, all->cost, 1e-6 * all->cost);
    EXPECT_LE((quick->q - all->q).cwiseAbs().maxCoeff(), 1e-8);
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const double value = choices[i].values[static_cast<std::size_t>(quick->values[i])];
      EXPECT_NEAR(choices[i].form.At(quick->q), value, 1e-8);
    }
    EXPECT_TRUE(set.feasible().Violations(quick->q, 1e-8).empty());
  }
  EXPECT_GT(found, 0);
}

// Some choices may have none of their values, at a price, and some combinations may not be taken.
TEST_P(AlignmentSearchTest, PruningChangesNothingWhereChoicesAreLeftAndCombinationsRefused) {
  const Design& design = ShippedDesign(GetParam());
  const MovableSet set(*design.assembly);
  std::mt19937_64 random(23);
  int left = 0, given_up = 0;
  for (int trial = 0; trial < 12; ++trial) {
    std::vector<ChoiceOfPlanes> choices = RandomChoices(design, random);
    choices[0].worth = choices[1].worth = std::numeric_limits<double>::infinity();
    choices[2].worth = std::exponential_distribution<double>(100)(random);
    choices[3].worth = std::exponential_distribution<double>(1000)(random);
    const auto salt = static_cast<int>(random() % 1000);
    const auto is_admissible = [&](const std::vector<int>& values) -> absl::StatusOr<bool> {
      if (trial == 0) return values[0] == kNoPlane;
      int sum = salt;
      for (const int value : values) sum = 31 * sum + value + 1;
      return sum % 40 == 0;
    };
    ASSERT_OK_AND_ASSIGN(const auto quick,
                         ChoosePlanes(set, InSpace(design), choices, is_admissible));
    ASSERT_OK_AND_ASSIGN(const auto all,
                         EnumeratePlanes(set, InSpace(design), choices, is_admissible));
    ASSERT_EQ(quick.has_value(), all.has_value());
    if (!quick) continue;
    EXPECT_EQ(quick->values, all->values);
    EXPECT_EQ(quick->given_up, all->given_up);
    EXPECT_NEAR(quick->cost, all->cost, 1e-6 * all->cost);
    EXPECT_LE((quick->q - all->q).cwiseAbs().maxCoeff(), 1e-8);
    ASSERT_OK_AND_ASSIGN(const bool may_be, is_admissible(quick->values));
    EXPECT_TRUE(may_be);
    left += static_cast<int>(std::count(quick->values.begin() + 2, quick->values.end(), kNoPlane));
    given_up += quick->given_up;
  }
  EXPECT_GT(left, 0);
  EXPECT_GT(given_up, 0);
}

INSTANTIATE_TEST_SUITE_P(Collection, AlignmentSearchTest,
                         ::testing::Values("bookshelf", "dining_table", "toy_chest",
                                           "garden_bench"),
                         [](const auto& shipped) { return shipped.param; });

TEST(AlignmentSearchTest, WithoutChoicesItStaysWhereItIs) {
  const Design& design = ShippedDesign("bookshelf");
  const MovableSet set(*design.assembly);
  ASSERT_OK_AND_ASSIGN(const auto stays, ChoosePlanes(set, InSpace(design), {}));
  ASSERT_TRUE(stays.has_value());
  EXPECT_LE((stays->q - InSpace(design)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(stays->cost, 0, 1e-12);
}

TEST(AlignmentSearchTest, WhatCannotBeIsNoChoice) {
  const Design& design = ShippedDesign("bookshelf");
  const MovableSet set(*design.assembly);
  // Plywood comes in one thickness.
  std::vector<ChoiceOfPlanes> choices;
  for (const PrincipalPart& part : PrincipalPartsOf(design)) {
    if (part.name != "side 1") continue;
    choices.push_back({part.size[0], {0.017, 0.02}});
  }
  ASSERT_OK_AND_ASSIGN(const auto none, ChoosePlanes(set, InSpace(design), choices));
  EXPECT_FALSE(none.has_value());
  choices.front().worth = std::numeric_limits<double>::infinity();
  ASSERT_OK_AND_ASSIGN(const auto left, ChoosePlanes(set, InSpace(design), choices));
  ASSERT_TRUE(left.has_value());
  EXPECT_EQ(left->values, std::vector<int>{kNoPlane});
  EXPECT_EQ(left->given_up, 1);
}

// A place is taken up to the price that it is worth.
TEST(AlignmentSearchTest, WhatCostsMoreThanItIsWorthIsLeft) {
  const Design& design = ShippedDesign("bookshelf");
  const MovableSet set(*design.assembly);
  std::vector<ChoiceOfPlanes> choices;
  for (const PrincipalPart& part : PrincipalPartsOf(design)) {
    if (part.name == "shelf 3") choices = {{part.size[0], {0.97 * part.box.size().x()}}};
  }
  ASSERT_EQ(choices.size(), 1U);
  ASSERT_OK_AND_ASSIGN(const auto price, ChoosePlanes(set, InSpace(design), choices));
  ASSERT_TRUE(price.has_value());
  ASSERT_GT(price->cost, 1e-6);
  for (const double share : {0.9, 1.1}) {
    choices.front().worth = share * price->cost;
    ASSERT_OK_AND_ASSIGN(const auto chosen, ChoosePlanes(set, InSpace(design), choices));
    ASSERT_TRUE(chosen.has_value());
    EXPECT_EQ(chosen->values.front(), share < 1 ? kNoPlane : 0);
    EXPECT_NEAR(chosen->cost, std::min(share, 1.0) * price->cost, 1e-9);
  }
}

}  // namespace
}  // namespace mortise::composer
