// Ranges, tags, names and types of files: what clients send, and what services say.
#include "gateway/http/file_conditions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Ranges, AreOfTheFile) {
  const struct {
    const char* text;
    int64_t first, last;
  } kGood[] = {{"bytes=0-0", 0, 0},    {"bytes=10-19", 10, 19},
               {"bytes=90-", 90, 99},  {"bytes=-1", 99, 99},
               {"bytes=-500", 0, 99},  {"bytes=50-99999", 50, 99},
               {"BYTES = 1-2", 0, -1}, {" bytes= 1 - 2 ", 1, 2},
               {"Bytes=1-2", 1, 2},    {"bytes=1-99999999999999999999", 1, 99}};
  for (const auto& [text, first, last] : kGood) {
    const RangeChoice choice = ChooseRange(text, 100);
    EXPECT_TRUE(choice.satisfiable) << text;
    if (last < 0) {
      EXPECT_FALSE(choice.range) << text;
      continue;
    }
    ASSERT_TRUE(choice.range) << text;
    EXPECT_EQ(choice.range->first, first) << text;
    EXPECT_EQ(choice.range->last, last) << text;
  }
}

TEST(Ranges, ThatCannotBeReadAreTheWholeFile) {
  for (const char* text : {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=5-2", "items=0-1",
                           "bytes=0-1,2-3", "bytes=--1", "bytes=+1-2", "bytes=0x1-2"}) {
    const RangeChoice choice = ChooseRange(text, 100);
    EXPECT_TRUE(choice.satisfiable) << text;
    EXPECT_FALSE(choice.range) << text;
  }
}

TEST(Ranges, BeyondTheFileCannotBeHad) {
  for (const auto& [text, size] :
       std::vector<std::pair<const char*, int64_t>>{{"bytes=100-", 100},
                                                    {"bytes=100-200", 100},
                                                    {"bytes=-0", 100},
                                                    {"bytes=0-0", 0},
                                                    {"bytes=-5", 0},
                                                    {"bytes=99999999999999999999-", 100}}) {
    EXPECT_FALSE(ChooseRange(text, size).satisfiable) << text;
  }
}

TEST(Tags, AreFoundInLists) {
  const std::string tag = "\"abc\"";
  for (const char* list : {"\"abc\"", "W/\"abc\"", "\"x\",\"abc\"", "\"x\" , W/\"abc\" ", " * "}) {
    EXPECT_TRUE(NamesTag(list, tag)) << list;
  }
  for (const char* list : {"", "abc", "\"abcd\"", "\"ab\", \"c\"", ",,", "W/"}) {
    EXPECT_FALSE(NamesTag(list, tag)) << list;
  }
  EXPECT_TRUE(AllowsRange("", tag));
  EXPECT_TRUE(AllowsRange("\"abc\"", tag));
  EXPECT_FALSE(AllowsRange("W/\"abc\"", tag)) << "a weak tag is not of the same bytes";
  EXPECT_FALSE(AllowsRange("Sat, 28 Nov 2026 00:00:00 GMT", tag));
}

TEST(Attachments, HaveNamesAndNothingElse) {
  EXPECT_EQ(AttachmentNamed("table.step"), "attachment; filename=\"table.step\"");
  EXPECT_EQ(AttachmentNamed(""), "attachment");
  EXPECT_EQ(AttachmentNamed(".."), "attachment");
  EXPECT_EQ(AttachmentNamed("../../etc/passwd"), "attachment; filename=\"passwd\"");
  EXPECT_EQ(AttachmentNamed("größe 1.csv"),
            "attachment; filename=\"gr____e 1.csv\"; filename*=UTF-8''gr%C3%B6%C3%9Fe%201.csv");
  const std::string attack = AttachmentNamed("a\"\r\nSet-Cookie: x\\\n.csv");
  EXPECT_THAT(attack, Not(HasSubstr("\r")));
  EXPECT_THAT(attack, Not(HasSubstr("\n")));
  EXPECT_EQ(std::count(attack.begin(), attack.end(), '"'), 2);
}

TEST(MediaTypes, ThatAreNoneAreBytes) {
  for (const char* good :
       {"model/step", "image/svg+xml", "text/csv; charset=utf-8", "model/gltf-binary"}) {
    EXPECT_EQ(SafeMediaType(good), good);
  }
  for (const char* bad :
       {"", "text", "/x", "x/", "text/html\r\nX: y", "text/html, text/plain", "a/\"b\""}) {
    EXPECT_EQ(SafeMediaType(bad), "application/octet-stream") << bad;
  }
}

}  // namespace
}  // namespace mortise::gateway
