// Parts with sloped ends on boards, held against arithmetic on corners that shares nothing with the
// planner.
#include "services/fabplanner/cutting/sloped_packing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <vector>

#include "common/base/errors.h"
#include "services/fabplanner/cutting/cutting_stock.h"
#include "tests/unit/services/fabplanner/board_corners.h"

namespace mortise::fabplanner {
namespace {

using testing::HasSubstr;

constexpr double kDegree = M_PI / 180;

// Whether one solid is the other turned by half a turn or not at all.
bool AreTurned(const CutEnds& ends, const CutEnds& laid, double length,
               const Eigen::Vector2d& section) {
  const Corners as_is = CornersOf(ends, 0, length, section);
  const Corners placed = CornersOf(laid, 0, length, section);
  const auto agree = [&](bool end_for_end, std::array<int, 4> corner) {
    for (int i = 0; i < 4; ++i) {
      const double front = end_for_end ? length - as_is.rear[corner[i]] : as_is.front[corner[i]];
      const double rear = end_for_end ? length - as_is.front[corner[i]] : as_is.rear[corner[i]];
      if (std::abs(front - placed.front[i]) > 1e-9 || std::abs(rear - placed.rear[i]) > 1e-9) {
        return false;
      }
    }
    return true;
  };
  // Corners are (-, -), (+, -), (-, +), (+, +) of v and w.
  return agree(false, {0, 1, 2, 3}) || agree(false, {3, 2, 1, 0}) || agree(true, {2, 3, 0, 1}) ||
         agree(true, {1, 0, 3, 2});
}

void ExpectSound(const std::vector<CrosscutPart>& parts, const std::vector<StockLength>& stock,
                 const CuttingStockOptions& options, const CuttingStock& cut) {
  std::vector<int> times(parts.size(), 0);
  double cost = 0;
  for (const CutBoard& board : cut.boards) {
    const double length = stock[board.stock].length;
    cost += stock[board.stock].cost > 0 ? stock[board.stock].cost : length;
    ASSERT_EQ(board.parts.size(), board.starts.size());
    ASSERT_EQ(board.parts.size(), board.ends.size());
    std::vector<Corners> placed;
    for (std::size_t i = 0; i < board.parts.size(); ++i) {
      const CrosscutPart& part = parts[board.parts[i]];
      ++times[board.parts[i]];
      EXPECT_TRUE(AreTurned(part.ends, board.ends[i], part.length, options.section));
      placed.push_back(CornersOf(board.ends[i], board.starts[i], part.length, options.section));
      EXPECT_GE(placed.back().First(), options.trim - kRounding);
      EXPECT_LE(placed.back().Last(), length - options.trim + kRounding);
      if (i == 0) continue;
      EXPECT_TRUE(
          ArePartedBySaw(placed[i - 1], board.ends[i - 1], placed[i], board.ends[i], options.kerf))
          << "parts " << i - 1 << " and " << i;
    }
    EXPECT_GE(board.offcut, 0);
    EXPECT_LE(board.offcut, length - placed.back().Last() + kRounding);
  }
  EXPECT_EQ(std::count(times.begin(), times.end(), 1), static_cast<std::ptrdiff_t>(parts.size()));
  EXPECT_NEAR(cut.cost, cost, 1e-6);
  EXPECT_LE(cut.lower_bound, cut.cost + 1e-9);
  if (cut.optimal) {
    EXPECT_NEAR(cut.lower_bound, cut.cost, 1e-9);
  }
}

struct Case {
  std::vector<CrosscutPart> parts;
  std::vector<StockLength> stock;
  CuttingStockOptions options;
};

Case RandomCase(unsigned seed, int most_parts) {
  std::mt19937 random(seed);
  const auto below = [&](int limit) { return static_cast<int>(random() % limit); };
  const auto millimetres = [&](int least, int most) {
    return 1e-3 * (least + below(most - least + 1));
  };
  Case made;
  made.options.search_steps = 200000;
  made.options.kerf = below(4) == 0 ? 0 : millimetres(1, 5);
  made.options.trim = below(3) == 0 ? 0 : std::max(made.options.kerf, millimetres(1, 20));
  made.options.section = {millimetres(10, 120), millimetres(5, 60)};
  made.stock = {{2.4}};
  if (below(3) == 0) made.stock.push_back({1.8});
  // From designs of one or two angles to any.
  const int variety = below(3);
  const auto angle = [&](int most) {
    constexpr double kCommon[] = {0, 45, 45, 22.5, 30};
    const double sign = below(2) == 0 ? -1 : 1;
    if (variety < 2) return sign * kDegree * kCommon[below(variety == 0 ? 3 : 5)];
    return sign * kDegree * below(most * 10) / 10;
  };
  const auto end = [&] {
    const bool has_bevel = below(3) == 0;
    return below(5) == 0 ? EndSlope{} : SlopeOf(angle(50), has_bevel ? angle(45) : 0);
  };
  const int count = 1 + below(most_parts);
  for (int i = 0; i < count; ++i) {
    CrosscutPart part{"part", 0, {end(), end()}};
    const double least = ReachOf(part.ends.front, made.options.section) +
                         ReachOf(part.ends.rear, made.options.section);
    part.length = 2 * least + millimetres(20, 900);
    made.parts.push_back(part);
  }
  return made;
}

std::vector<CrosscutPart> AsRectangles(std::vector<CrosscutPart> parts) {
  for (CrosscutPart& part : parts) part.ends = {};
  return parts;
}

TEST(SlopedPackingTest, RandomPartsAreSoundAndNeverCostMoreThanRectangles) {
  int saved = 0, proven = 0;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(seed);
    const Case made = RandomCase(seed, 30);
    const auto cut = CutStock(made.parts, made.stock, made.options);
    ASSERT_TRUE(cut.ok()) << cut.status();
    ExpectSound(made.parts, made.stock, made.options, *cut);
    const auto rectangles = CutStock(AsRectangles(made.parts), made.stock, made.options);
    ASSERT_TRUE(rectangles.ok());
    EXPECT_LE(cut->cost, rectangles->cost + 1e-9);
    saved += cut->cost < rectangles->cost - 1e-9 ? 1 : 0;
    proven += cut->optimal ? 1 : 0;
  }
  EXPECT_GT(saved, 15);
  EXPECT_GT(proven, 100);
}

// The least length that parts take of a board, by trying all orders and ways to lie.
double LeastTaken(const std::vector<CrosscutPart>& parts, const CuttingStockOptions& options) {
  std::vector<int> order(parts.size());
  std::iota(order.begin(), order.end(), 0);
  double least = 1e9;
  const auto apart = [&](const EndSlope& rear, const EndSlope& front) {
    // Pushes the two together until a blade along either, or square between them, just fits.
    double touching = -1e9, square_rear = -1e9, square_front = 1e9;
    for (int i = 0; i < 4; ++i) {
      const double r = AtCorner(rear, i, options.section);
      const double f = AtCorner(front, i, options.section);
      touching = std::max(touching, r - f);
      square_rear = std::max(square_rear, r);
      square_front = std::min(square_front, f);
    }
    const auto along = [&](const EndSlope& end) {
      return options.kerf * std::hypot(1, std::hypot(end.across, end.through));
    };
    return std::min({touching + along(rear), touching + along(front),
                     square_rear - square_front + options.kerf});
  };
  do {
    int ways = 1;
    for (std::size_t i = 0; i < parts.size(); ++i) ways *= 4;
    for (int way = 0; way < ways; ++way) {
      double middle = 0, first = 0;
      EndSlope before;
      for (std::size_t i = 0, rest = way; i < order.size(); ++i, rest /= 4) {
        const CrosscutPart& part = parts[order[i]];
        CutEnds ends = part.ends;
        if (rest % 4 == 1) ends = TurnedAboutLength(ends);
        if (rest % 4 == 2) ends = TurnedAboutWidth(ends);
        if (rest % 4 == 3) ends = TurnedAboutThickness(ends);
        if (i == 0) first = -ReachOf(ends.front, options.section);
        if (i > 0) middle += apart(before, ends.front);
        middle += part.length - ReachOf(ends.front, options.section) -
                  ReachOf(ends.rear, options.section);
        before = ends.rear;
      }
      least = std::min(least, middle + ReachOf(before, options.section) - first);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

// The fewest boards of one length, by trying all ways to share the parts out.
int FewestBoards(const Case& made) {
  const int all = (1 << made.parts.size()) - 1;
  std::vector<int> fewest(all + 1, 1000);
  std::vector<bool> fits(all + 1, false);
  for (int set = 1; set <= all; ++set) {
    std::vector<CrosscutPart> chosen;
    for (std::size_t i = 0; i < made.parts.size(); ++i) {
      if (set >> i & 1) chosen.push_back(made.parts[i]);
    }
    fits[set] = LeastTaken(chosen, made.options) <=
                made.stock.front().length - 2 * made.options.trim + 1e-7;
  }
  fewest[0] = 0;
  for (int set = 1; set <= all; ++set) {
    for (int one = set; one > 0; one = (one - 1) & set) {
      if (fits[one]) fewest[set] = std::min(fewest[set], fewest[set & ~one] + 1);
    }
  }
  return fewest[all];
}

TEST(SlopedPackingTest, SmallCasesAreAsGoodAsAnyAndBoundsHold) {
  int as_good = 0, cases = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Case made = RandomCase(seed, 5);
    made.stock = {{0.9}};
    for (CrosscutPart& part : made.parts) part.length = std::min(part.length, 0.8);
    if (std::any_of(made.parts.begin(), made.parts.end(), [&](const CrosscutPart& part) {
          const Corners corners = CornersOf(part.ends, 0, part.length, made.options.section);
          for (int i = 0; i < 4; ++i) {
            if (corners.front[i] > corners.rear[i]) return true;
          }
          return false;
        })) {
      continue;
    }
    const auto cut = CutStock(made.parts, made.stock, made.options);
    ASSERT_TRUE(cut.ok()) << cut.status();
    const int fewest = FewestBoards(made);
    EXPECT_GE(static_cast<int>(cut->boards.size()), fewest);
    EXPECT_LE(std::lround(cut->lower_bound / 0.9), fewest);
    if (cut->optimal) {
      EXPECT_EQ(static_cast<int>(cut->boards.size()), fewest);
    }
    ++cases;
    as_good += static_cast<int>(cut->boards.size()) == fewest ? 1 : 0;
  }
  EXPECT_GT(cases, 40);
  EXPECT_EQ(as_good, cases);
}

std::vector<CrosscutPart> Frame(double width, double height) {
  const CutEnds mitred = {SlopeOf(45 * kDegree, 0), SlopeOf(-45 * kDegree, 0)};
  return {{"top", width, mitred},
          {"bottom", width, mitred},
          {"left", height, mitred},
          {"right", height, mitred}};
}

TEST(SlopedPackingTest, FrameOfFourMitredPartsSharesItsCuts) {
  // 400 × 300 mm of a moulding 45 mm wide: along the middle line the parts are 355 and 255 mm long,
  // each of the three cuts between them takes 3 √2 mm, and the ends reach 22.5 mm over at both
  // sides.
  const double taken = 2 * 0.355 + 2 * 0.255 + 3 * 0.003 * std::sqrt(2) + 0.045;
  const CuttingStockOptions options = {.section = {0.045, 0.02}};
  const std::vector<CrosscutPart> parts = Frame(0.4, 0.3);
  const auto cut = CutStock(parts, {{1.3}}, options);
  ASSERT_TRUE(cut.ok()) << cut.status();
  ASSERT_EQ(cut->boards.size(), 1);
  ExpectSound(parts, {{1.3}}, options, *cut);
  EXPECT_TRUE(cut->optimal);
  const CutBoard& board = cut->boards.front();
  EXPECT_NEAR(board.starts.back() + parts[board.parts.back()].length, 0.01 + taken, 1e-7);
  EXPECT_NEAR(board.offcut, 1.3 - 0.01 - taken - 0.003 * std::sqrt(2), 1e-7);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(board.ends[i].front, board.ends[i - 1].rear);

  // As rectangles they need 1400 mm and three square cuts, and a board more.
  EXPECT_EQ(CutStock(AsRectangles(parts), {{1.3}}, options)->boards.size(), 2);
  // With a millimetre less of board than they take they need two.
  EXPECT_EQ(CutStock(parts, {{taken + 0.019}}, options)->boards.size(), 2);
  EXPECT_EQ(CutStock(parts, {{taken + 0.020001}}, options)->boards.size(), 1);
}

TEST(SlopedPackingTest, ManyFramesArePackedToTheBound) {
  std::vector<CrosscutPart> parts;
  for (int i = 0; i < 250; ++i) {
    for (const CrosscutPart& part : Frame(0.4, 0.3)) parts.push_back(part);
  }
  const CuttingStockOptions options = {.section = {0.045, 0.02}};
  const auto cut = CutStock(parts, {{2.4}}, options);
  ASSERT_TRUE(cut.ok()) << cut.status();
  ExpectSound(parts, {{2.4}}, options, *cut);
  const auto rectangles = CutStock(AsRectangles(parts), {{2.4}}, options);
  EXPECT_LT(cut->boards.size(), rectangles->boards.size());
  EXPECT_LE(cut->cost, 1.02 * cut->lower_bound);
}

// Ends that differ by less than a micrometre are cut as one; that must not add up over many parts.
TEST(SlopedPackingTest, EndsThatAreNearlyAlikeAddNothingUp) {
  const CuttingStockOptions options = {.section = {0.045, 0.02}};
  const double off = 0.9e-6 / options.section.x();
  constexpr int kParts = 40;
  std::vector<CrosscutPart> parts = {{"first", 0.05, {{1 - off, 0}, {1 - off, 0}}}};
  while (parts.size() < kParts) parts.push_back({"other", 0.05, {{1, 0}, {1, 0}}});
  const double taken = kParts * (0.05 - 0.045) + (kParts - 1) * 0.003 * std::sqrt(2) + 0.045;
  const std::vector<StockLength> stock = {{taken + 2 * options.trim + 5e-6}};
  const auto cut = CutStock(parts, stock, options);
  ASSERT_TRUE(cut.ok()) << cut.status();
  EXPECT_EQ(cut->boards.size(), 1U);
  EXPECT_NEAR(cut->lower_bound, stock.front().length, 1e-9);
  ExpectSound(parts, stock, options, *cut);
}

// A wedge is a triangle at the shortest; ends that run alike never cross, however short the part.
TEST(SlopedPackingTest, EndsMustNotCrossWithinThePart) {
  const CuttingStockOptions options = {.section = {0.045, 0.02}};
  const auto fault = [&](double length, double front, double rear) {
    const auto cut = CutStock({{"part", length, {{front, 0}, {rear, 0}}}}, {{2.4}}, options);
    return DetailOf(cut.status()).field;
  };
  EXPECT_EQ(fault(0.0901, 1, -1), "");
  EXPECT_EQ(fault(0.0899, 1, -1), "parts[0].ends");
  EXPECT_EQ(fault(0.046, 1, -1), "parts[0].ends");
  EXPECT_EQ(fault(0.0451, 1, 1), "");
  EXPECT_EQ(fault(0.0449, 1, 1), "parts[0].ends");
  EXPECT_EQ(fault(0.0451, 1, 0), "");
  EXPECT_EQ(fault(0.0449, 1, 0), "parts[0].ends");
}

TEST(SlopedPackingTest, WhatCannotBeIsNamed) {
  const CutEnds mitred = {SlopeOf(45 * kDegree, 0), SlopeOf(-45 * kDegree, 0)};
  const auto none = CutStock({{"rail", 0.4, mitred}}, {{2.4}}, {});
  EXPECT_EQ(DetailOf(none.status()).field, "section");
  const auto steep = CutStock({{"rail", 0.03, mitred}}, {{2.4}}, {.section = {0.09, 0.02}});
  EXPECT_EQ(DetailOf(steep.status()).field, "parts[0].ends");
  const auto infinite =
      CutStock({{"rail", 0.03, {{INFINITY, 0}, {}}}}, {{2.4}}, {.section = {0.09, 0.02}});
  EXPECT_EQ(DetailOf(infinite.status()).field, "parts[0].ends");
  const auto longer = CutStock({{"rail", 2.5, mitred}}, {{2.4}}, {.section = {0.09, 0.02}});
  EXPECT_EQ(DetailOf(longer.status()).reason, "PART_TOO_LONG");
  EXPECT_THAT(std::string(longer.status().message()), HasSubstr("part rail is 2500 mm long"));
}

}  // namespace
}  // namespace mortise::fabplanner
