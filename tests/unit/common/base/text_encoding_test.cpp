#include "common/base/text_encoding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/base/errors.h"

namespace mortise {
namespace {

using ::testing::HasSubstr;

TEST(TextEncoding, SkipsOneMarkOfUtf8) {
  EXPECT_EQ(SkipByteOrderMark("\xEF\xBB\xBF{}"), "{}");
  EXPECT_EQ(SkipByteOrderMark("{}"), "{}");
  EXPECT_EQ(SkipByteOrderMark("\xEF\xBB\xBF\xEF\xBB\xBF"), "\xEF\xBB\xBF");
  EXPECT_EQ(SkipByteOrderMark(""), "");
  EXPECT_EQ(SkipByteOrderMark("\xEF\xBB"), "\xEF\xBB");
}

// `unit` bytes a character.
std::string Wide(const std::string& text, std::size_t unit, bool is_big, bool is_marked) {
  std::string wide;
  const auto add = [&](const std::string& low_first) {
    std::string bytes = low_first + std::string(unit - low_first.size(), '\0');
    if (is_big) bytes = std::string(bytes.rbegin(), bytes.rend());
    wide += bytes;
  };
  if (is_marked) add("\xFF\xFE");
  for (const char c : text) add(std::string(1, c));
  return wide;
}

TEST(TextEncoding, NamesOtherEncodingsAndSaysHowToConvertThem) {
  for (const bool is_big : {false, true}) {
    for (const bool is_marked : {false, true}) {
      for (const std::size_t unit : {2, 4}) {
        const std::string name = unit == 2 ? "UTF-16" : "UTF-32";
        const auto text = WithoutByteOrderMark(Wide("{\"a\"}", unit, is_big, is_marked), "case");
        ASSERT_FALSE(text.ok()) << name << is_big << is_marked;
        EXPECT_EQ(DetailOf(text.status()).field, "case");
        EXPECT_THAT(std::string(text.status().message()),
                    HasSubstr("is " + name + ", not UTF-8; save it as UTF-8"));
        EXPECT_THAT(std::string(text.status().message()), HasSubstr("iconv -f " + name));
      }
    }
  }
}

TEST(TextEncoding, LeavesOthersToTheirReaders) {
  for (const std::string& text : {std::string(), std::string("{}"), std::string("\0\0\0\0", 4),
                                  std::string("Stra\xDF"), std::string("ab\0\0", 4)}) {
    EXPECT_EQ(EncodingFault(text), "");
  }
}

}  // namespace
}  // namespace mortise
