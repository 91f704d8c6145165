// Boards: every part once, kerf and trims kept, offcuts add up, clear failures.
#include "services/fabplanner/cutting/cutting_stock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/base/errors.h"

namespace mortise::fabplanner {
namespace {

using testing::HasSubstr;

constexpr double kTolerance = 1e-6;

void ExpectValid(const std::vector<CrosscutPart>& parts, const std::vector<StockLength>& stock,
                 const CuttingStockOptions& options, const CuttingStock& cut) {
  std::vector<int> seen(parts.size(), 0);
  for (const CutBoard& board : cut.boards) {
    ASSERT_EQ(board.parts.size(), board.starts.size());
    ASSERT_FALSE(board.parts.empty());
    const double length = stock[board.stock].length;
    double position = options.trim;
    double used = options.trim;
    for (std::size_t i = 0; i < board.parts.size(); ++i) {
      ++seen[board.parts[i]];
      EXPECT_NEAR(board.starts[i], position, kTolerance);  // kerf between neighbours
      position = board.starts[i] + parts[board.parts[i]].length;
      EXPECT_LE(position, length - options.trim + kTolerance);
      position += options.kerf;
      used += parts[board.parts[i]].length + options.kerf;
    }
    EXPECT_GE(board.offcut, 0);
    if (board.offcut > 0) {
      EXPECT_NEAR(used + board.offcut, length, kTolerance);
    }
  }
  EXPECT_THAT(seen, testing::Each(1));
  EXPECT_LE(cut.lower_bound, cut.cost + kTolerance);
}

TEST(CuttingStockTest, KerfDecidesHowManyPartsFit) {
  // Four parts of 600 mm from 2400 mm: only if the saw took nothing.
  const std::vector<CrosscutPart> parts(4, {"leg", 0.6});
  const auto ideal = CutStock(parts, {{2.4}}, {.kerf = 0, .trim = 0});
  ASSERT_TRUE(ideal.ok()) << ideal.status();
  EXPECT_EQ(ideal->boards.size(), 1);
  EXPECT_DOUBLE_EQ(ideal->boards[0].offcut, 0);
  const auto real = CutStock(parts, {{2.4}}, {.kerf = 0.003, .trim = 0});
  ASSERT_TRUE(real.ok()) << real.status();
  EXPECT_EQ(real->boards.size(), 2);
  EXPECT_TRUE(real->optimal);
  // 4 · 594.75 + 3 · 3 = 2388 fits 2400 less 2 · 6.
  const auto tight = CutStock(std::vector<CrosscutPart>(4, {"leg", 0.59475}), {{2.4}},
                              {.kerf = 0.003, .trim = 0.006});
  ASSERT_TRUE(tight.ok()) << tight.status();
  EXPECT_EQ(tight->boards.size(), 1);
  EXPECT_NEAR(tight->boards[0].offcut, 0.003, kTolerance);
}

TEST(CuttingStockTest, RandomOrdersKeepTheInvariants) {
  std::mt19937 random(3);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  for (int trial = 0; trial < 100; ++trial) {
    CuttingStockOptions options{.kerf = uniform(0, 0.005), .trim = uniform(0.005, 0.03)};
    options.search_steps = 100000;
    std::vector<StockLength> stock = {{uniform(1.5, 3)}};
    if (trial % 2 == 1) stock.push_back({uniform(3, 5)});
    std::vector<CrosscutPart> parts(1 + random() % 40);
    for (CrosscutPart& part : parts) part = {"p", uniform(0.05, 1.4)};
    const auto cut = CutStock(parts, stock, options);
    ASSERT_TRUE(cut.ok()) << cut.status();
    ExpectValid(parts, stock, options, *cut);
  }
}

TEST(CuttingStockTest, TakesTheCheaperMixOfStockLengths) {
  // One part of 2.3 m and one of 1.4 m: a 2.4 and a 1.5 waste less than one 4.8 or two 2.4.
  const auto cut = CutStock({{"a", 2.3}, {"b", 1.4}}, {{4.8}, {2.4}, {1.5}}, {.trim = 0.01});
  ASSERT_TRUE(cut.ok()) << cut.status();
  EXPECT_TRUE(cut->optimal);
  EXPECT_NEAR(cut->cost, 3.9, kTolerance);
  // Unless the long board is on sale.
  const auto sale =
      CutStock({{"a", 2.3}, {"b", 1.4}}, {{4.8, 3}, {2.4, 4}, {1.5, 2}}, {.trim = 0.01});
  ASSERT_TRUE(sale.ok()) << sale.status();
  EXPECT_NEAR(sale->cost, 3, kTolerance);
  EXPECT_EQ(sale->boards.size(), 1);
}

TEST(CuttingStockTest, NamesThePartThatIsTooLong) {
  const auto cut = CutStock({{"leg_1", 0.7}, {"apron_front", 2.395}}, {{2.4}}, {.trim = 0.01});
  EXPECT_EQ(cut.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(cut.status()).reason, "PART_TOO_LONG");
  EXPECT_THAT(cut.status().message(), HasSubstr("apron_front"));
  EXPECT_THAT(cut.status().message(), HasSubstr("2395 mm"));
  EXPECT_THAT(cut.status().message(), HasSubstr("2400 mm"));
  EXPECT_THAT(cut.status().message(), HasSubstr("2380 mm"));
}

// What does not fit must not read as if it did.
TEST(CuttingStockTest, TellsALengthFromOneThatIsHardlyLess) {
  const auto cut = CutStock({{"e", 2.4200001}}, {{2.44}}, {.trim = 0.01});
  EXPECT_THAT(cut.status().message(), HasSubstr("part e is 2420.0001 mm long"));
  EXPECT_THAT(cut.status().message(), HasSubstr("of which 2420 mm remain"));
}

TEST(CuttingStockTest, RefusesUnusableNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<CrosscutPart> parts = {{"a", 0.5}};
  const auto field = [](const absl::StatusOr<CuttingStock>& cut) {
    EXPECT_EQ(cut.status().code(), absl::StatusCode::kInvalidArgument) << cut.status();
    return DetailOf(cut.status()).field;
  };
  EXPECT_EQ(field(CutStock(parts, {{2.4}}, {.kerf = nan})), "kerf");
  EXPECT_EQ(field(CutStock(parts, {{2.4}}, {.kerf = -1})), "kerf");
  EXPECT_EQ(field(CutStock(parts, {{2.4}}, {.trim = infinity})), "trim");
  EXPECT_EQ(field(CutStock(parts, {}, {})), "stock");
  EXPECT_EQ(field(CutStock(parts, {{2.4}, {nan}}, {})), "stock[1].length");
  EXPECT_EQ(field(CutStock(parts, {{2.4, 1}, {3.0, 0}}, {})), "stock[1].cost");
  EXPECT_EQ(field(CutStock({{"a", 0.5}, {"b", 0}}, {{2.4}}, {})), "parts[1].length");
  EXPECT_EQ(field(CutStock({{"a", nan}}, {{2.4}}, {})), "parts[0].length");
  // Trims longer than the board leave nothing, rather than something negative.
  EXPECT_EQ(CutStock(parts, {{2.4}}, {.trim = 2}).status().code(),
            absl::StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace mortise::fabplanner
