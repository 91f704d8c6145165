#include "services/fabplanner/planning/planning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(PlanningTest, PlansOneTable) {
  const auto plan = MakePlan(ExampleTable(), ExampleItems(), 1);
  ASSERT_TRUE(plan.ok()) << plan.status();
  // As Table 8.2 counts: eight chop-saw parts, one jigsaw part.
  EXPECT_EQ(plan->chop_saw_parts, 8);
  EXPECT_EQ(plan->jigsaw_parts, 1);
  EXPECT_EQ(plan->pegs, 22);
  EXPECT_EQ(plan->steps.size(), 3);
  EXPECT_EQ(plan->holes.size(), 44);
  // Legs of 720 mm: three to a board of 2.4 m; aprons 2 × 1110 and 2 × 610 mm take two boards.
  ASSERT_EQ(plan->boards.size(), 4);
  EXPECT_TRUE(plan->boards_proven_optimal);
  EXPECT_EQ(plan->boards[0].item, "items/apron-20");
  EXPECT_EQ(plan->boards[0].label, "board-1");
  EXPECT_DOUBLE_EQ(plan->boards[0].width, 0.09);
  EXPECT_EQ(plan->sheets.size(), 1);
  EXPECT_EQ(plan->sheets[0].placements[0].part, "top");
  // 2 · 6.48 + 2 · 9.50 + 22 · 0.042 + 89
  EXPECT_DOUBLE_EQ(plan->bill.totals.at(0).amount, 12.96 + 19 + 89 + 0.92);
}

TEST(PlanningTest, EveryLabelOfEveryCopyIsCutOnce) {
  const int quantity = 7;
  const Design design = ExampleTable();
  const auto plan = MakePlan(design, ExampleItems(), quantity);
  ASSERT_TRUE(plan.ok()) << plan.status();
  std::map<std::string, int> cut;
  for (const BoardLayout& board : plan->boards) {
    for (const BoardSegment& segment : board.segments) ++cut[segment.part];
  }
  for (const SheetLayout& sheet : plan->sheets) {
    for (const SheetPlacement& placement : sheet.placements) ++cut[placement.part];
  }
  EXPECT_EQ(cut.size(), design.parts.size() * quantity);
  for (const Part& part : design.parts) {
    for (int copy = 1; copy <= quantity; ++copy) {
      EXPECT_EQ(cut[PartLabel(part.name, copy, quantity)], 1) << part.name << " " << copy;
    }
  }
  EXPECT_EQ(plan->pegs, 22 * quantity);
  EXPECT_EQ(plan->holes.size(), 44);
}

TEST(PlanningTest, NamesTheRuleOrQuantityAtFault) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto field = [](int quantity, const WorkshopRules& rules) {
    const auto plan = MakePlan(ExampleTable(), ExampleItems(), quantity, rules);
    EXPECT_EQ(plan.status().code(), absl::StatusCode::kInvalidArgument) << plan.status();
    return DetailOf(plan.status()).field;
  };
  EXPECT_EQ(field(0, {}), "quantity");
  EXPECT_EQ(field(1001, {}), "quantity");
  EXPECT_EQ(field(1, {.kerf = nan}), "rules.kerf");
  EXPECT_EQ(field(1, {.kerf = -0.003}), "rules.kerf");
  EXPECT_EQ(field(1, {.board_trim = 0.001}), "rules.board_trim");
  EXPECT_EQ(field(1, {.sheet_trim = std::numeric_limits<double>::infinity()}), "rules.sheet_trim");
  EXPECT_EQ(field(1, {.sheet_spacing = 0.001}), "rules.sheet_spacing");
  EXPECT_EQ(field(1, {.mitre_limit = -0.1}), "rules.mitre_limit");
  EXPECT_EQ(field(1, {.mitre_limit = 50}), "rules.mitre_limit");  // degrees
  EXPECT_EQ(field(1, {.bevel_limit = nan}), "rules.bevel_limit");
  EXPECT_EQ(field(1, {.jigsaw_radius = 10}), "rules.jigsaw_radius");  // millimetres
}

TEST(PlanningTest, NamesEveryRuleAtFault) {
  const auto fields = [](const WorkshopRules& rules) {
    std::vector<std::string> found;
    for (const FieldViolation& violation : AllViolationsOf(CheckRules(rules))) {
      found.push_back(violation.field);
    }
    return found;
  };
  EXPECT_THAT(fields({.kerf = -1, .board_trim = 0.001, .sheet_trim = 2, .sheet_spacing = 0}),
              ElementsAre("rules.kerf", "rules.sheet_trim"));
  EXPECT_THAT(fields({.kerf = 0.003, .board_trim = 0.001, .sheet_trim = -1, .sheet_spacing = 0}),
              ElementsAre("rules.board_trim", "rules.sheet_trim", "rules.sheet_spacing"));
  EXPECT_THAT(fields({}), ElementsAre());
}

TEST(PlanningTest, NamesThePartThatIsLongerThanItsStock) {
  Items items = ExampleItems();
  items["items/apron-20"].size.x() = 1.0;
  const auto plan = MakePlan(ExampleTable(), items, 3);
  EXPECT_EQ(DetailOf(plan.status()).reason, "PART_TOO_LONG");
  EXPECT_THAT(plan.status().message(), HasSubstr("apron_front.1 is 1110 mm long"));
  EXPECT_THAT(plan.status().message(), HasSubstr("1000 mm"));
}

TEST(PlanningTest, RefusesDesignsItCannotUse) {
  EXPECT_EQ(MakePlan({}, ExampleItems(), 1).status().code(), absl::StatusCode::kInvalidArgument);
  Design unknown = ExampleTable();
  unknown.parts[2].item = "items/none";
  EXPECT_EQ(DetailOf(MakePlan(unknown, ExampleItems(), 1).status()).field, "part leg_3");
  Design broken = ExampleTable();
  broken.parts[0].size.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(DetailOf(MakePlan(broken, ExampleItems(), 1).status()).field, "part leg_1");
  Design large = ExampleTable();
  large.parts.resize(11, large.parts[0]);
  EXPECT_EQ(MakePlan(large, ExampleItems(), 1000).status().code(),
            absl::StatusCode::kResourceExhausted);
}

TEST(PlanningTest, SheetOutlineIsSeenFromItsTop) {
  Part part = BoxPart("p", "i", CutProcess::kJigsaw, {1, 2, 3}, {1.018, 2.5, 4}, 2, 0);
  part.extrusion_axis = 0;  // (u, v) are (y, z); the item's length lies along z
  part.outline = {{2, 3}, {2.5, 3}, {2.5, 3.2}, {2, 4}};
  part.from = 1;
  part.to = 1.018;
  const auto outline = SheetOutlineOf(part);
  ASSERT_EQ(outline.size(), 4);
  double area = 0;
  Eigen::Vector2d upper(0, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % 4];
    area += (a.x() * b.y() - b.x() * a.y()) / 2;
    upper = upper.cwiseMax(a);
    EXPECT_GE(a.minCoeff(), 0);
  }
  EXPECT_NEAR(area, 0.5 * (1 + 0.2) / 2, 1e-12);
  EXPECT_NEAR(upper.x(), 1.0, 1e-12);  // along the length
  EXPECT_NEAR(upper.y(), 0.5, 1e-12);
}

}  // namespace
}  // namespace mortise::fabplanner
