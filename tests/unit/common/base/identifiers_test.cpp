#include "common/base/identifiers.h"

#include <gtest/gtest.h>

#include <set>

namespace mortise {
namespace {

TEST(NewIdentifier, IsUniqueAndAValidResourceId) {
  std::set<std::string> seen;
  for (int i = 0; i < 10000; ++i) {
    const std::string id = NewIdentifier();
    EXPECT_TRUE(IsResourceId(id)) << id;
    EXPECT_TRUE(seen.insert(id).second) << id;
  }
}

TEST(NewIdentifier, SortsByAge) {
  const std::string first = NewIdentifier();
  EXPECT_LE(first.substr(0, 10), NewIdentifier().substr(0, 10));
}

TEST(IsResourceId, AcceptsOnlyLowerCaseDigitsAndInnerHyphens) {
  for (const char* good : {"a", "table", "board-38x89", "0"})
    EXPECT_TRUE(IsResourceId(good)) << good;
  for (const char* bad : {"", "-a", "a-", "A", "a/b", "a b", "ä", "a..b"}) {
    EXPECT_FALSE(IsResourceId(bad)) << bad;
  }
  EXPECT_TRUE(IsResourceId(std::string(63, 'a')));
  EXPECT_FALSE(IsResourceId(std::string(64, 'a')));
}

TEST(ParseResourceName, ReturnsTheIdOrNamesTheField) {
  EXPECT_EQ(ParseResourceName("templates/table", "templates", "name").value(), "table");
  for (const char* bad : {"table", "items/table", "templates/", "templates/a/b", "Templates/a"}) {
    const absl::Status status = ParseResourceName(bad, "templates", "name").status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad;
    EXPECT_EQ(status.message().substr(0, 5), "name:") << bad;
  }
}

}  // namespace
}  // namespace mortise
