#include "services/fabplanner/plan_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/fabplanner/planning.h"
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
  for (const auto& row : rows) EXPECT_EQ(row.size(), 9);
  EXPECT_EQ(rows[1][0], "board-1");
  EXPECT_EQ(rows[1][2], "crosscut");
  EXPECT_EQ(rows[1][4], "10");    // behind the trim
  EXPECT_EQ(rows[1][6], "1110");  // the longest apron
  EXPECT_EQ(rows[9][2], "outline");
  EXPECT_EQ(rows[9][6], "1300");
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

}  // namespace
}  // namespace mortise::fabplanner
