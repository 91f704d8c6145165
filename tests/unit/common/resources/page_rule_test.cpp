// The rule of pages: sizes, bytes, and how a request for one that cannot be is refused.
#include "common/resources/page_rule.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "common/base/field_violations.h"

namespace mortise::resources {
namespace {

TEST(PageRule, TakesSizesFromNothingToTheLargest) {
  EXPECT_EQ(ReadPageQuery(0, "")->size, kDefaultPageSize);
  EXPECT_EQ(ReadPageQuery(1, "")->size, 1);
  EXPECT_EQ(ReadPageQuery(kMaxPageSize, "")->size, kMaxPageSize);
  for (const int size : {-1, kMaxPageSize + 1}) {
    const absl::Status refused = ReadPageQuery(size, "").status();
    EXPECT_EQ(DetailOf(refused).field, "page_size");
    EXPECT_NE(refused.message().find("must be 0 to 1000"), absl::string_view::npos) << refused;
  }
}

TEST(PageRule, TakesPositionsThatMayBeKeys) {
  EXPECT_EQ(ReadPageQuery(0, "webhooks/a/stream/0000000000000000012")->after,
            "webhooks/a/stream/0000000000000000012");
  for (const std::string& position :
       {std::string("a b"), std::string("a\0b", 3), std::string("\xff"), std::string(5000, 'a')}) {
    const absl::Status refused = ReadPageQuery(0, position).status();
    EXPECT_EQ(DetailOf(refused).field, "page_token");
    EXPECT_EQ(refused, NotAPageToken());
  }
  EXPECT_EQ(ViolationsOf(ReadPageQuery(-1, "a b").status()).size(), 2u) << "both are told";
}

TEST(PageRoom, EndsWithTheEntriesOrBeforeTheBytes) {
  PageRoom few(2);
  EXPECT_TRUE(few.Take(1));
  EXPECT_TRUE(few.Take(1));
  EXPECT_FALSE(few.Take(1));
  PageRoom small(1000);
  EXPECT_TRUE(small.Take(kMaxPageBytes - 10));
  EXPECT_FALSE(small.Take(11));
  EXPECT_TRUE(small.Take(10));
  PageRoom one(1000);
  EXPECT_TRUE(one.Take(2 * kMaxPageBytes)) << "else nobody could ever see it";
  EXPECT_FALSE(one.Take(1));
}

}  // namespace
}  // namespace mortise::resources
