// Round numbers along axes, and how short they are written.
#include "common/render/axis_numbers.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mortise::render {
namespace {

TEST(Ticks, AreRoundAndInside) {
  EXPECT_EQ(NiceTicks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  for (const double low : {-3.7, 0.0, 1e-7, 2e8}) {
    for (const double range : {1e-3, 0.9, 47.0, 1e6}) {
      const auto ticks = NiceTicks(low, low + range, 6);
      EXPECT_GE(ticks.size(), 3u);
      EXPECT_LE(ticks.size(), 13u);
      EXPECT_GE(ticks.front(), low - 1e-6 * range);
      EXPECT_LE(ticks.back(), low + range * (1 + 1e-6));
    }
  }
}

TEST(Numbers, AreShort) {
  EXPECT_EQ(ShortNumber(0), "0");
  EXPECT_EQ(ShortNumber(0.25), "0.25");
  EXPECT_EQ(ShortNumber(1234.5), "1234");
  EXPECT_EQ(ShortNumber(-12), "-12");
  EXPECT_EQ(ShortNumber(1.5e9), "1.5e9");
  EXPECT_EQ(ShortNumber(2e-7), "2e-7");
}

TEST(Numbers, OfOneAxisDiffer) {
  using Texts = std::vector<std::string>;
  EXPECT_EQ(ShortNumbers({0, 0.5, 1}), (Texts{"0", "0.5", "1"}));
  EXPECT_EQ(ShortNumbers({293.15, 293.4}, 3), (Texts{"293.1", "293.4"}));
  EXPECT_EQ(ShortNumbers({1e7, 1e7 + 1}, 3), (Texts{"1e7", "1.0000001e7"}));
  EXPECT_EQ(ShortNumbers({2, 2}, 3), (Texts{"2", "2"}));
  EXPECT_TRUE(ShortNumbers({}).empty());
}

}  // namespace
}  // namespace mortise::render
