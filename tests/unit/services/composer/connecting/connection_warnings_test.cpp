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
