// Random plans, held against what a workshop needs, by arithmetic that shares nothing with the
// planner: every part is cut once, nothing overlaps, saws have their kerf and ends their trim, and
// what is bought is what is cut.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "services/fabplanner/cutting/stock_cutting.h"
#include "services/fabplanner/planning/part_making.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

constexpr double kRounding = 1e-8;  // m

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  int Below(int limit) { return static_cast<int>(generator_() % static_cast<unsigned>(limit)); }
  // Whole millimetres.
  double Length(int least, int most) { return 1e-3 * (least + Below(most - least + 1)); }

 private:
  std::mt19937 generator_;
};

struct Case {
  Design design;
  Items items;
  FabricationPlan plan;
  std::vector<Purchase> purchases;
};

WorkshopRules RandomRules(Random& random) {
  WorkshopRules rules;
  rules.kerf = random.Below(4) == 0 ? 0 : random.Length(1, 5);
  rules.board_trim = random.Below(3) == 0 ? 0 : std::max(rules.kerf, random.Length(1, 20));
  rules.sheet_trim = random.Below(3) == 0 ? 0 : random.Length(1, 20);
  rules.sheet_spacing = std::max(rules.kerf, random.Length(0, 12));
  return rules;
}

Case RandomCase(unsigned seed) {
  Random random(seed);
  Case made;
  made.items["items/plank"] = {.name = "items/plank",
                               .title = "Plank",
                               .kind = ItemKind::kBoard,
                               .size = {2.4, random.Length(80, 300), 0.02},
                               .price = {"EUR", 12},
                               .ripped = true};
  made.items["items/batten"] = {.name = "items/batten",
                                .title = "Batten",
                                .kind = ItemKind::kBoard,
                                .size = {3, 0.04, 0.02},
                                .price = {"EUR", 4},
                                .stock = {{1.5, 0, 2.5}, {3, 0, std::nullopt}, {2, 0, 3.0}}};
  made.items["items/panel"] = {.name = "items/panel",
                               .title = "Panel",
                               .kind = ItemKind::kSheet,
                               .size = {2, 1, 0.018},
                               .price = {"EUR", 40},
                               .has_grain = random.Below(2) == 0};
  made.plan.rules = RandomRules(random);
  made.plan.quantity = 1 + random.Below(3);
  const double plank_width = made.items["items/plank"].size.y();
  const int parts = 1 + random.Below(25);
  for (int i = 0; i < parts; ++i) {
    const std::string name = absl::StrCat("part_", i);
    const int kind = random.Below(3);
    if (kind == 2) {
      made.design.parts.push_back(BoxPart(name, "items/panel", CutProcess::kJigsaw, {0, 0, 0},
                                          {random.Length(50, 900), random.Length(50, 900), 0.018},
                                          0, 2));
      continue;
    }
    const bool is_plank = kind == 0;
    const double width = !is_plank ? 0.04
                         : random.Below(6) == 0
                             ? plank_width
                             : random.Length(15, static_cast<int>(plank_width * 1e3 + 0.5));
    made.design.parts.push_back(BoxPart(name, is_plank ? "items/plank" : "items/batten",
                                        CutProcess::kChopSaw, {0, 0, 0},
                                        {random.Length(60, 2000), width, 0.02}, 0, 2));
  }
  const auto planned = PlanParts(made.design, made.items);
  EXPECT_TRUE(planned.ok()) << planned.status();
  made.plan.parts = *planned;
  const absl::Status cut = CutParts(made.design, made.items, &made.plan, &made.purchases);
  EXPECT_TRUE(cut.ok()) << cut;
  return made;
}

void ExpectEveryPartOnce(const Case& made) {
  std::map<std::string, int> times;
  for (const BoardLayout& board : made.plan.boards) {
    for (const BoardSegment& segment : board.segments) ++times[segment.part];
  }
  for (const SheetLayout& sheet : made.plan.sheets) {
    for (const SheetPlacement& placement : sheet.placements) ++times[placement.part];
  }
  EXPECT_EQ(times.size(), made.design.parts.size() * made.plan.quantity);
  for (const auto& [part, count] : times) EXPECT_EQ(count, 1) << part;
}

void ExpectCrosscutsApart(const Case& made) {
  const WorkshopRules& rules = made.plan.rules;
  std::map<std::string, const Part*> part_of;
  for (const Part& part : made.design.parts) part_of[part.name] = &part;
  for (const BoardLayout& board : made.plan.boards) {
    double end = rules.board_trim - rules.kerf;
    for (const BoardSegment& segment : board.segments) {
      EXPECT_GE(segment.start, end + rules.kerf - kRounding) << board.label;
      end = segment.start + segment.length;
      const Part& part = *part_of.at(segment.part.substr(0, segment.part.find('.')));
      EXPECT_NEAR(segment.length, part.size.x(), kRounding);
      EXPECT_NEAR(board.width, part.size.y(), kRounding);
      EXPECT_EQ(board.item, part.item);
    }
    EXPECT_LE(end, board.stock_length - rules.board_trim + kRounding) << board.label;
  }
}

// Strips lie beside each other on a plank as long as they are, and every plank is bought.
void ExpectStripsApart(const Case& made) {
  const Item& plank = made.items.at("items/plank");
  std::map<std::string, std::vector<const BoardLayout*>> strips;
  int whole = 0;
  for (const BoardLayout& board : made.plan.boards) {
    if (board.item != plank.name) {
      EXPECT_EQ(board.plank, "");
      continue;
    }
    if (board.plank.empty()) {
      EXPECT_NEAR(board.width, plank.size.y(), kRounding);
      ++whole;
    } else {
      strips[board.plank].push_back(&board);
    }
  }
  std::map<double, int> strips_by_width;
  for (auto& [label, beside] : strips) {
    std::sort(beside.begin(), beside.end(), [](const BoardLayout* a, const BoardLayout* b) {
      return a->plank_position < b->plank_position;
    });
    double end = -made.plan.rules.kerf;
    for (const BoardLayout* strip : beside) {
      EXPECT_GE(strip->plank_position, end + made.plan.rules.kerf - kRounding) << label;
      EXPECT_EQ(strip->stock_length, beside.front()->stock_length);
      EXPECT_EQ(strip->thickness, beside.front()->thickness);
      end = strip->plank_position + strip->width;
      ++strips_by_width[strip->width];
    }
    EXPECT_LE(end, plank.size.y() + kRounding) << label;
  }
  int before = 0;
  for (const auto& [width, count] : strips_by_width) {
    const double kerf = made.plan.rules.kerf;
    const int each = std::max(1, static_cast<int>((plank.size.y() + kerf) / (width + kerf) + 1e-9));
    before += (count + each - 1) / each;
  }
  EXPECT_LE(static_cast<int>(strips.size()), before);
  int bought = 0;
  for (const Purchase& purchase : made.purchases) {
    if (purchase.item == plank.name) bought += purchase.quantity;
  }
  EXPECT_EQ(bought, whole + static_cast<int>(strips.size()));
}

struct Rectangle {
  Eigen::Vector2d lower, upper;
};

Rectangle AroundOf(const std::vector<Eigen::Vector2d>& outline) {
  Rectangle around{outline.front(), outline.front()};
  for (const Eigen::Vector2d& point : outline) {
    around.lower = around.lower.cwiseMin(point);
    around.upper = around.upper.cwiseMax(point);
  }
  return around;
}

void ExpectOutlinesApart(const Case& made) {
  const WorkshopRules& rules = made.plan.rules;
  std::map<std::string, const Part*> part_of;
  for (const Part& part : made.design.parts) part_of[part.name] = &part;
  for (const SheetLayout& sheet : made.plan.sheets) {
    std::vector<Rectangle> placed;
    for (const SheetPlacement& placement : sheet.placements) {
      const Rectangle around = AroundOf(placement.outline);
      const Eigen::Vector2d size = around.upper - around.lower;
      const Part& part = *part_of.at(placement.part.substr(0, placement.part.find('.')));
      const bool is_straight = std::abs(size.x() - part.size.x()) < kRounding &&
                               std::abs(size.y() - part.size.y()) < kRounding;
      const bool is_turned = std::abs(size.x() - part.size.y()) < kRounding &&
                             std::abs(size.y() - part.size.x()) < kRounding;
      EXPECT_TRUE(is_straight || (is_turned && !made.items.at(sheet.item).has_grain))
          << placement.part;
      EXPECT_GE(around.lower.minCoeff(), rules.sheet_trim - kRounding);
      EXPECT_LE(around.upper.x(), sheet.length - rules.sheet_trim + kRounding);
      EXPECT_LE(around.upper.y(), sheet.width - rules.sheet_trim + kRounding);
      for (const Rectangle& other : placed) {
        const double gap = std::max((around.lower - other.upper).maxCoeff(),
                                    (other.lower - around.upper).maxCoeff());
        EXPECT_GE(gap, rules.sheet_spacing - kRounding) << placement.part;
      }
      placed.push_back(around);
    }
  }
}

TEST(CuttingInvariants, HoldForRandomPlans) {
  for (unsigned seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE(seed);
    const Case made = RandomCase(seed);
    ExpectEveryPartOnce(made);
    ExpectCrosscutsApart(made);
    ExpectStripsApart(made);
    ExpectOutlinesApart(made);
  }
}

}  // namespace
}  // namespace mortise::fabplanner
