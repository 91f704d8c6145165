// Sheets: every outline once, none overlapping, spacing and trims kept; published sizes of
// problems.
#include "services/fabplanner/cutting/sheet_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include "common/base/errors.h"
#include "tests/unit/services/fabplanner/cutting/cutting_data.h"

namespace mortise::fabplanner {
namespace {

using testing::HasSubstr;

constexpr double kTolerance = 1e-6;

std::vector<Eigen::Vector2d> Rectangle(double length, double width) {
  return {{0, 0}, {length, 0}, {length, width}, {0, width}};
}

struct Box {
  Eigen::Vector2d lower, upper;
};

Box BoxOf(const std::vector<Eigen::Vector2d>& outline) {
  Box box{outline.front(), outline.front()};
  for (const Eigen::Vector2d& point : outline) {
    box.lower = box.lower.cwiseMin(point);
    box.upper = box.upper.cwiseMax(point);
  }
  return box;
}

double Area(const std::vector<Eigen::Vector2d>& outline) {
  double area = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
    area += (a.x() * b.y() - b.x() * a.y()) / 2;
  }
  return area;
}

void ExpectValid(const std::vector<SheetOutline>& outlines, const SheetStock& stock,
                 const SheetLayoutOptions& options, const std::vector<FilledSheet>& sheets) {
  std::vector<int> seen(outlines.size(), 0);
  for (const FilledSheet& sheet : sheets) {
    std::vector<Box> boxes;
    for (const PlacedOutline& placed : sheet.placements) {
      ++seen[placed.part];
      EXPECT_TRUE(!placed.turned || outlines[placed.part].may_turn);
      // Turned and moved, but neither mirrored nor stretched.
      EXPECT_NEAR(Area(placed.outline), Area(outlines[placed.part].outline), kTolerance);
      const Box box = BoxOf(placed.outline);
      EXPECT_GE(box.lower.minCoeff(), options.trim - kTolerance);
      EXPECT_LE(box.upper.x(), stock.length - options.trim + kTolerance);
      EXPECT_LE(box.upper.y(), stock.width - options.trim + kTolerance);
      for (const Box& other : boxes) {
        const double gap_u =
            std::max(box.lower.x() - other.upper.x(), other.lower.x() - box.upper.x());
        const double gap_v =
            std::max(box.lower.y() - other.upper.y(), other.lower.y() - box.upper.y());
        EXPECT_GE(std::max(gap_u, gap_v), options.spacing - kTolerance);
      }
      boxes.push_back(box);
    }
  }
  EXPECT_THAT(seen, testing::Each(1));
}

TEST(SheetLayoutTest, RandomOutlinesKeepTheInvariants) {
  std::mt19937 random(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  for (int trial = 0; trial < 40; ++trial) {
    const SheetStock stock{2.44, 1.22};
    const SheetLayoutOptions options{uniform(0, 0.02), uniform(0.003, 0.02)};
    std::vector<SheetOutline> outlines(1 + random() % 40);
    for (SheetOutline& outline : outlines) {
      const double length = uniform(0.05, 1.1), width = uniform(0.05, 1.1);
      outline = {"p", Rectangle(length, width), random() % 2 == 0};
      if (random() % 2 == 0) {  // an L, away from the origin
        outline.outline = {{3, 3},
                           {3 + length, 3},
                           {3 + length, 3 + width / 2},
                           {3 + length / 2, 3 + width / 2},
                           {3 + length / 2, 3 + width},
                           {3, 3 + width}};
      }
    }
    const auto sheets = LayOutSheets(outlines, stock, options);
    ASSERT_TRUE(sheets.ok()) << sheets.status();
    ExpectValid(outlines, stock, options, *sheets);
  }
}

TEST(SheetLayoutTest, PerfectFitUsesOneSheet) {
  // Four quarters of the usable area less the spacing.
  const std::vector<SheetOutline> quarters(4, {"q", Rectangle(0.485, 0.235)});
  const auto sheets = LayOutSheets(quarters, {1.0, 0.5}, {.trim = 0.01, .spacing = 0.01});
  ASSERT_TRUE(sheets.ok()) << sheets.status();
  EXPECT_EQ(sheets->size(), 1);
  ExpectValid(quarters, {1.0, 0.5}, {.trim = 0.01, .spacing = 0.01}, *sheets);
}

TEST(SheetLayoutTest, TurnsOnlyWhereTheGrainAllows) {
  const SheetStock stock{1.0, 0.5};
  const auto turned = LayOutSheets({{"shelf", Rectangle(0.4, 0.8), true}}, stock);
  ASSERT_TRUE(turned.ok()) << turned.status();
  EXPECT_TRUE(turned->at(0).placements.at(0).turned);
  const auto refused = LayOutSheets({{"shelf", Rectangle(0.4, 0.8), false}}, stock);
  EXPECT_EQ(DetailOf(refused.status()).reason, "PART_TOO_LARGE");
  EXPECT_THAT(refused.status().message(), HasSubstr("shelf is 400 × 800 mm"));
  EXPECT_THAT(refused.status().message(), HasSubstr("grain"));
}

// What does not fit must not read as if it did.
TEST(SheetLayoutTest, TellsASizeFromOneThatIsHardlyLess) {
  const auto refused =
      LayOutSheets({{"shelf", Rectangle(1.00001, 0.5), false}}, {1.0, 0.5}, {.trim = 0});
  EXPECT_THAT(refused.status().message(), HasSubstr("shelf is 1000.01 × 500 mm"));
  EXPECT_THAT(refused.status().message(), HasSubstr("of which 1000 × 500 mm remain"));
}

// Demands of Cintra and others 2008, for which three-stage guillotine cutting needs 294 sheets.
TEST(SheetLayoutTest, PublishedDemandsComeNearTheBestKnown) {
  std::ifstream file(DataFile("guillotine.txt"));
  while (file.peek() == '#') file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  std::string name;
  double sheet_width = 0, sheet_height = 0;
  int best_known = 0, kinds = 0;
  ASSERT_TRUE(file >> name >> sheet_width >> sheet_height >> best_known >> kinds);
  EXPECT_EQ(best_known, 294);
  std::vector<SheetOutline> outlines;
  double area = 0;
  for (; kinds > 0; --kinds) {
    int width = 0, height = 0, copies = 0;
    ASSERT_TRUE(file >> width >> height >> copies);
    for (int copy = 0; copy < copies; ++copy) {
      outlines.push_back({"p", Rectangle(width / 100.0, height / 100.0)});
      area += width / 100.0 * height / 100.0;
    }
  }
  const SheetStock stock{sheet_width / 100, sheet_height / 100};
  const SheetLayoutOptions options{0, 0};
  const auto sheets = LayOutSheets(outlines, stock, options);
  ASSERT_TRUE(sheets.ok()) << sheets.status();
  ExpectValid(outlines, stock, options, *sheets);
  EXPECT_GE(static_cast<double>(sheets->size()), area / (stock.length * stock.width));
  EXPECT_LE(sheets->size(), 297);  // 1 % more
}

TEST(SheetLayoutTest, RefusesUnusableNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto field = [](const absl::StatusOr<std::vector<FilledSheet>>& sheets) {
    EXPECT_EQ(sheets.status().code(), absl::StatusCode::kInvalidArgument) << sheets.status();
    return DetailOf(sheets.status()).field;
  };
  const SheetOutline good{"a", Rectangle(0.1, 0.1)};
  EXPECT_EQ(field(LayOutSheets({good}, {1, 1}, {.trim = nan})), "trim");
  EXPECT_EQ(field(LayOutSheets({good}, {1, 1}, {.spacing = -0.1})), "spacing");
  EXPECT_EQ(field(LayOutSheets({good}, {nan, 1})), "stock");
  EXPECT_EQ(field(LayOutSheets({good, {"b", {{0, 0}, {1, 1}}}}, {1, 1})), "outlines[1]");
  EXPECT_EQ(field(LayOutSheets({{"b", Rectangle(nan, 1)}}, {1, 1})), "outlines[0]");
  EXPECT_EQ(field(LayOutSheets({{"b", {{0, 0}, {1, 0}, {2, 0}}}}, {1, 1})), "outlines[0]");
  EXPECT_TRUE(LayOutSheets({}, {1, 1}).value().empty());
}

}  // namespace
}  // namespace mortise::fabplanner
