// Warnings are few, whatever number of pairs they are of.
#include "services/composer/connecting/connection_warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace mortise::composer {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::Pair;
using ::testing::SizeIs;

TEST(ConnectionWarningsTest, EachReasonIsSaidOnce) {
  std::vector<LeftPair> left;
  for (int i = 0; i < 10; ++i) {
    left.push_back({LeftPair::Reason::kNoSuch, "post " + std::to_string(i), "board", ""});
  }
  left.insert(left.begin() + 1,
              {LeftPair::Reason::kNearest, "rail", "board",
               "'a' with 'b' of assemblies/c, does not fit: one thing; another; a third"});
  const auto warnings = WarningsOf(left);
  ASSERT_THAT(warnings, SizeIs(2));
  EXPECT_EQ(warnings[0].first, "post 0");
  EXPECT_THAT(warnings[0].others, SizeIs(9));
  EXPECT_THAT(warnings[0].others, ::testing::Contains(Pair("post 9", "board")));
  EXPECT_THAT(warnings[0].text, HasSubstr("nothing holds 'post 0' and 'board' together"));
  EXPECT_THAT(warnings[0].text, HasSubstr("nor 7 other pairs"));
  EXPECT_EQ(warnings[1].first, "rail");
  EXPECT_THAT(warnings[1].text, HasSubstr("does not fit: one thing"));
  EXPECT_THAT(warnings[1].text, Not(HasSubstr("another")));
  EXPECT_THAT(WarningsOf({}), IsEmpty());
}

// No pair is told a reason that is another's.
TEST(ConnectionWarningsTest, ReasonsThatReadOtherwiseAreOthers) {
  using enum LeftPair::Reason;
  const std::vector<LeftPair> left{{kOriginal, "a", "board", "a screw would run 3 mm into 'a'"},
                                   {kOriginal, "b", "board", "they are apart"},
                                   {kOriginal, "c", "board", "they are apart"},
                                   {kNearest, "d", "board", "they are apart"}};
  const auto warnings = WarningsOf(left);
  ASSERT_THAT(warnings, SizeIs(3));
  EXPECT_THAT(warnings[0].text, HasSubstr("would run 3 mm"));
  EXPECT_THAT(warnings[0].others, IsEmpty());
  EXPECT_EQ(warnings[1].first, "b");
  EXPECT_THAT(warnings[1].others, ::testing::ElementsAre(Pair("c", "board")));
  EXPECT_THAT(warnings[1].text, HasSubstr("the original design does not fit: they are apart; nor"));
  EXPECT_THAT(warnings[2].text, HasSubstr("the nearest of the collection, they are apart"));
}

TEST(ConnectionWarningsTest, OfAMotionTheFirstReasonsAreSaid) {
  using enum LeftPair::Reason;
  const WantedMotion slides{true, parametric::JointKind::kPrismatic, "by 'its slide'"};
  const ConnectionWarning one =
      WarningOfMotion({{kNoSuch, "a", "side", ""}, {kNoSuch, "b", "side", ""}}, "box", slides);
  EXPECT_EQ(one.text,
            "'box' is to slide by 'its slide', and nothing lets it: the collection has no slides "
            "or hinges for 'a' and 'side' and 1 other pair");
  EXPECT_THAT(one.others, ::testing::ElementsAre(Pair("b", "side")));
  const ConnectionWarning more = WarningOfMotion({{kNoSuch, "a", "side", ""},
                                                  {kOriginal, "b", "side", "one thing"},
                                                  {kOriginal, "c", "side", "another"},
                                                  {kOriginal, "d", "side", "a third"}},
                                                 "box", slides);
  EXPECT_THAT(more.text, HasSubstr("; between 'b' and 'side': the connection of the original "
                                   "design does not fit: one thing; and 2 more reasons"));
}

TEST(ConnectionWarningsTest, TheyAreShort) {
  std::string detail;
  for (int i = 0; i < 200; ++i) detail += "word ";
  const auto warnings = WarningsOf({{LeftPair::Reason::kOriginal, "post", "board", detail}});
  ASSERT_THAT(warnings, SizeIs(1));
  EXPECT_LT(warnings[0].text.size(), 300U);
  EXPECT_THAT(warnings[0].text, HasSubstr("word …"));
}

}  // namespace
}  // namespace mortise::composer
