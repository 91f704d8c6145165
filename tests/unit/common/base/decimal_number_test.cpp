#include "common/base/decimal_number.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cstdint>

namespace mortise {
namespace {

TEST(DecimalNumber, TakesDecimalNotation) {
  const struct {
    const char* text;
    double value;
  } numbers[] = {{"0", 0},      {"-0.5", -0.5},   {"+3", 3},         {"12.", 12},
                 {".25", 0.25}, {"1e3", 1000},    {"1E-3", 1e-3},    {"2.5e+2", 250},
                 {"007", 7},    {"1e308", 1e308}, {"1e-310", 1e-310}};
  for (const auto& [text, value] : numbers) {
    ASSERT_TRUE(DecimalNumber(text).has_value()) << text;
    EXPECT_EQ(*DecimalNumber(text), value) << text;
  }
}

TEST(DecimalNumber, TakesNothingElse) {
  for (const char* const text :
       {"",       "0x10",   "0X1p3", "inf",   "-inf", "infinity", "nan", "NaN", "nan(1)", "1e400",
        "-1e400", "1e-400", "1_000", "1'000", "1,5",  "1 000",    " 1",  "1 ",  "++1",    "+-1",
        "-+1",    ".",      "e3",    "1e",    "1e+",  "1.2.3",    "1d3", "0b1", "½",      "１"}) {
    EXPECT_FALSE(DecimalNumber(text).has_value()) << text;
  }
}

TEST(DecimalNumber, IsTheSameInEveryLocale) {
  for (const char* const name : {"de_DE.UTF-8", "C.UTF-8"}) {
    const char* const set = std::setlocale(LC_ALL, name);
    EXPECT_EQ(DecimalNumber("1.5").value_or(0), 1.5) << (set == nullptr ? "unknown here" : name);
    EXPECT_FALSE(DecimalNumber("1,5").has_value());
  }
  std::setlocale(LC_ALL, "C");
}

TEST(DecimalNumber, BeginsATextThatGoesOn) {
  const auto length = [](const char* text) {
    const auto prefix = DecimalNumberPrefix(text);
    return prefix ? static_cast<int>(prefix->length) : -1;
  };
  EXPECT_EQ(length("12mm"), 2);
  EXPECT_EQ(length("1.5e3 kg"), 5);
  EXPECT_EQ(length("3em"), 1);
  EXPECT_EQ(length("0x10"), 1);
  EXPECT_EQ(length("mm"), -1);
  EXPECT_EQ(length("inf"), -1);
}

TEST(DecimalNumber, WholeNumbersHaveNoPoint) {
  EXPECT_EQ(DecimalInteger("-12").value_or(0), -12);
  EXPECT_EQ(DecimalInteger("+7").value_or(0), 7);
  EXPECT_EQ(DecimalInteger("9223372036854775807").value_or(0), INT64_MAX);
  for (const char* const text : {"", "1.0", "0x10", "9223372036854775808", "++1", "+-1", " 1"}) {
    EXPECT_FALSE(DecimalInteger(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace mortise
