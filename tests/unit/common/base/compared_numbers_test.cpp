#include "common/base/compared_numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mortise {
namespace {

using ::testing::ElementsAre;

TEST(ComparedNumbers, LengthsThatDifferReadDifferently) {
  EXPECT_THAT(ComparedMillimetres({2.395, 2.4, 2.38}), ElementsAre("2395", "2400", "2380"));
  EXPECT_THAT(ComparedMillimetres({2.4200001, 2.44, 2.42}),
              ElementsAre("2420.0001", "2440", "2420"));
  EXPECT_THAT(ComparedMillimetres({0.01805, 0.018}), ElementsAre("18.1", "18"));
  EXPECT_THAT(ComparedMillimetres({0.018004, 0.018}), ElementsAre("18.004", "18"));
  EXPECT_THAT(ComparedMillimetres({100.000001, 100}), ElementsAre("100000.001", "100000"));
}

// Rounding is no difference that anybody could saw.
TEST(ComparedNumbers, WhatIsOnlyRoundingReadsTheSame) {
  EXPECT_THAT(ComparedMillimetres({0.1 + 0.2, 0.3}), ElementsAre("300", "300"));
  EXPECT_THAT(ComparedMillimetres({0, -1e-12}), ElementsAre("0", "0"));
}

TEST(ComparedNumbers, HaveTheDigitsThatItTakes) {
  EXPECT_THAT(ComparedNumbers({2.5, 0.5, 2.42}), ElementsAre("2.5", "0.5", "2.42"));
  EXPECT_THAT(ComparedNumbers({2.42000001, 0.5, 2.42}), ElementsAre("2.42000001", "0.5", "2.42"));
  EXPECT_THAT(ComparedNumbers({1, 1, 1}), ElementsAre("1", "1", "1"));
  EXPECT_THAT(ComparedNumbers({0.1 + 0.2, 0.3}),
              ElementsAre("0.30000000000000004", "0.29999999999999999"));
}

}  // namespace
}  // namespace mortise
