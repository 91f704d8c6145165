// Targets, lists, positions and numbers in URLs and headers.
#include "gateway/contract/query.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mortise::gateway {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(Query, ParsesTargets) {
  const auto target = ParseTarget("/events?streams=a%2Cb&after=-1&types=x+y&flag&&a=1&a=2#part");
  ASSERT_TRUE(target.ok()) << target.status();
  EXPECT_EQ(target->path, "/events");
  EXPECT_THAT(target->parameters, ElementsAre(Pair("a", "2"), Pair("after", "-1"), Pair("flag", ""),
                                              Pair("streams", "a,b"), Pair("types", "x y")));
  EXPECT_EQ(ParseTarget("/a%20b")->path, "/a b");
}

TEST(Query, RefusesMalformedTargets) {
  for (const std::string& bad :
       {std::string(), std::string("events"), std::string("/a%"), std::string("/a%2"),
        std::string("/a%zz"), std::string("/?x=%1"), "/" + std::string(9000, 'a')}) {
    EXPECT_FALSE(ParseTarget(bad).ok()) << bad.substr(0, 20);
  }
}

TEST(Query, TakesTheHostOfATarget) {
  const auto target = ParseTarget("http://localhost:7780/a?b=c");
  ASSERT_TRUE(target.ok()) << target.status();
  EXPECT_EQ(target->authority, "localhost:7780");
  EXPECT_EQ(target->path, "/a");
  EXPECT_EQ(target->parameters.at("b"), "c");
  EXPECT_EQ(ParseTarget("HTTPS://[::1]")->authority, "[::1]");
  EXPECT_EQ(ParseTarget("https://[::1]")->path, "/");
  EXPECT_EQ(ParseTarget("/x")->authority, "");
}

TEST(Query, KnowsTheNamesOfThisMachineForItself) {
  for (const char* own : {"localhost", "LocalHost:80", "127.0.0.1", "127.255.0.9:1", "[::1]",
                          "[::1]:7780", "[0:0:0:0:0:0:0:1]", "localhost:"}) {
    EXPECT_TRUE(IsLoopbackAuthority(own)) << own;
  }
  for (const char* other : {"",
                            "x",
                            "gateway",
                            "evil.example",
                            "localhost.evil.example",
                            "127.0.0.1.evil.example",
                            "127.1",
                            "0x7f.0.0.1",
                            "0177.0.0.1",
                            "2130706433",
                            "0.0.0.0",
                            "128.0.0.1",
                            "[::]",
                            "[::2]",
                            "[::1",
                            "::1",
                            "[::1]x",
                            "localhost:x",
                            "localhost:123456",
                            "localhost@evil.example",
                            "user@localhost",
                            "[localhost]",
                            "localhost ",
                            "app.localhost"}) {
    EXPECT_FALSE(IsLoopbackAuthority(other)) << other;
  }
}

TEST(Query, PositionsComeBackAsTheyWere) {
  const EventPosition position = {{"catalog", 12}, {"pareto", 0}};
  EXPECT_EQ(FormatPosition(position), "catalog:12,pareto:0");
  EXPECT_EQ(*ParsePosition(FormatPosition(position)), position);
  EXPECT_EQ(*ParsePosition("catalog:9223372036854775807"),
            (EventPosition{{"catalog", 9223372036854775807}}));
}

TEST(Query, RefusesMalformedPositions) {
  for (const char* bad : {"", "catalog", "catalog:", "catalog:-1", ":3", "Catalog:1", "a:1,a:2",
                          "a:1,,b:2", "a:99999999999999999999", "a: 1", "a:1x", "a/b:1"}) {
    EXPECT_FALSE(ParsePosition(bad).ok()) << bad;
  }
  std::string many;
  for (int i = 0; i < 70; ++i) many += (i ? ",s" : "s") + std::to_string(i) + ":1";
  EXPECT_FALSE(ParsePosition(many).ok());
}

TEST(Query, SplitsLists) {
  EXPECT_THAT(SplitList("a,,b,"), ElementsAre("a", "b"));
  EXPECT_TRUE(SplitList("").empty());
}

}  // namespace
}  // namespace mortise::gateway
