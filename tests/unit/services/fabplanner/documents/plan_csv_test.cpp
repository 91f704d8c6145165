#include "services/fabplanner/documents/plan_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/fabplanner/planning/planning.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// Reads RFC 4180 back.
std::vector<std::vector<std::string>> Parse(const std::string& csv) {
  std::vector<std::vector<std::string>> rows(1, {""});
  bool quoted = false;
  for (std::size_t i = 0; i < csv.size(); ++i) {
    if (quoted) {
      if (csv[i] == '"' && i + 1 < csv.size() && csv[i + 1] == '"') {
        rows.back().back() += csv[i++];
      } else if (csv[i] == '"') {
        quoted = false;
      } else {
        rows.back().back() += csv[i];
      }
    } else if (csv[i] == '"') {
      quoted = true;
    } else if (csv[i] == ',') {
      rows.back().emplace_back();
    } else if (csv[i] == '\r') {
      EXPECT_EQ(csv[++i], '\n');
      rows.push_back({""});
    } else {
      rows.back().back() += csv[i];
    }
  }
  rows.pop_back();
  return rows;
}

TEST(PlanCsvTest, CutListNamesEveryPartWithItsPlace) {
  const auto plan = MakePlan(ExampleTable(), ExampleItems(), 1);
  ASSERT_TRUE(plan.ok()) << plan.status();
  const auto rows = Parse(CutListCsv(*plan));
  ASSERT_EQ(rows.size(), 1 + 9);
  for (const auto& row : rows) EXPECT_EQ(row.size(), 13);
  EXPECT_EQ(rows[1][0], "board-1");
  EXPECT_EQ(rows[1][2], "crosscut");
  EXPECT_EQ(rows[1][4], "10");    // behind the trim
  EXPECT_EQ(rows[1][6], "1110");  // the longest apron
  EXPECT_EQ(rows[9][2], "outline");
  EXPECT_EQ(rows[9][6], "1300");
}

TEST(PlanCsvTest, CutListHasTheAnglesOfEnds) {
  FabricationPlan plan;
  plan.boards = {{"board-1", "items/apron-20", 0.09, 0.02, 1.2, {}, 0.1}};
  plan.boards[0].segments = {
      {"crown", 0.01, 0.4, {SlopeOf(-M_PI / 8, 0), SlopeOf(M_PI / 4, -M_PI / 6)}}};
  const auto rows = Parse(CutListCsv(plan));
  ASSERT_EQ(rows.size(), 2);
  EXPECT_EQ(rows[0][9], "front_mitre_deg");
  EXPECT_EQ(rows[0][12], "rear_bevel_deg");
  EXPECT_EQ(std::vector<std::string>(rows[1].begin() + 9, rows[1].end()),
            (std::vector<std::string>{"-22.5", "0", "45", "-30"}));
}

TEST(PlanCsvTest, BillQuotesWhatNeedsQuotes) {
  const auto plan = MakePlan(ExampleTable(), ExampleItems(), 1);
  ASSERT_TRUE(plan.ok()) << plan.status();
  const std::string csv = BillCsv(*plan);
  EXPECT_THAT(csv, StartsWith("item,title,quantity,size_to_order,"));
  EXPECT_THAT(csv, HasSubstr("\"Timber, Nails & \"\"Co\"\"\""));
  const auto rows = Parse(csv);
  ASSERT_EQ(rows.size(), 1 + 4 + 1);
  EXPECT_EQ(rows[2][4], "Timber, Nails & \"Co\"");
  EXPECT_EQ(rows[2][2], "2");
  EXPECT_EQ(rows[2][8], "19.00");
  EXPECT_EQ(rows[5][0], "total");
  EXPECT_EQ(rows[5][8], "121.88");
  EXPECT_EQ(rows[5][9], "EUR");
}

TEST(PlanCsvTest, PartsAndHolesAreAllThere) {
  const Design design = ExampleRack();
  const auto plan = MakePlan(design, ExampleItems(), 1);
  ASSERT_TRUE(plan.ok()) << plan.status();
  const auto parts = Parse(PartsCsv(*plan, design));
  ASSERT_EQ(parts.size(), 1 + design.parts.size());
  EXPECT_EQ(parts[1][2], "outline");
  EXPECT_EQ(parts[4][2], "bought");
  const auto holes = Parse(HolesCsv(*plan, design));
  ASSERT_EQ(holes.size(), 1 + plan->holes.size());
  EXPECT_THAT(holes[1], testing::ElementsAre("side 1", "clearance", "4.5", "18", "yes", "0", "150",
                                             "309", "towards +x", "shelf 1 screw left"));
  EXPECT_THAT(holes[2], testing::ElementsAre("shelf 1", "pilot", "3", "22", "no", "0", "150", "9",
                                             "towards +x", "shelf 1 screw left"));
}

}  // namespace
}  // namespace mortise::fabplanner
