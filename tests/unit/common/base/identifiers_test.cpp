#include "common/base/identifiers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <thread>
#include <vector>

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

TEST(NewIdentifier, SortsByAgeEvenWithinAMillisecond) {
  std::string last = NewIdentifier();
  for (int i = 0; i < 100000; ++i) {
    const std::string next = NewIdentifier();
    ASSERT_LT(last, next);
    last = next;
  }
}

TEST(NewIdentifier, IsUniqueAndSortedOnEveryThread) {
  std::vector<std::vector<std::string>> made(4);
  {
    std::vector<std::jthread> threads;
    for (std::vector<std::string>& mine : made) {
      threads.emplace_back([&mine] {
        for (int i = 0; i < 10000; ++i) mine.push_back(NewIdentifier());
      });
    }
  }
  std::set<std::string> all;
  for (const std::vector<std::string>& mine : made) {
    EXPECT_TRUE(std::is_sorted(mine.begin(), mine.end()));
    all.insert(mine.begin(), mine.end());
  }
  EXPECT_EQ(all.size(), 40000u);
}

TEST(IsResourceId, AcceptsOnlyLowerCaseDigitsAndInnerHyphens) {
  for (const char* good : {"a", "table", "board-38x89", "0"}) {
    EXPECT_TRUE(IsResourceId(good)) << good;
  }
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
