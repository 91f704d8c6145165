#include "services/fabplanner/documents/bill_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "absl/strings/str_split.h"
#include "tests/unit/services/fabplanner/documents/small_bill.h"

namespace mortise::fabplanner {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(BillTableTest, IsARowANodeWithItsLevelAndParent) {
  const std::string csv = BillTreeCsv(SmallBill());
  const std::vector<std::string> lines = absl::StrSplit(csv, "\r\n");
  ASSERT_EQ(lines.size(), 1u + 3u + 1u);
  EXPECT_THAT(lines[0],
              StartsWith("level,id,parent,kind,name,title,quantity,total_quantity,item,"));
  EXPECT_THAT(lines[1], StartsWith("0,1,,assembly,templates/table,'=1+1,1,2,templates/table,3,"));
  EXPECT_THAT(lines[2], StartsWith("1,1.1,1,part,leg,Leg,4,8,items/leg,5,"));
  EXPECT_THAT(lines[3],
              StartsWith("2,1.1.1,1.1,stock,items/leg,\"Pine, planed\",0.375,3,items/leg,5,"
                         "P-1; P-2,"));
  EXPECT_THAT(lines[3], HasSubstr(",2.4,0.045,0.045,2400 × 45 × 45 mm,9.50,28.50,EUR,"));
  EXPECT_THAT(lines[1], ::testing::EndsWith(",2023-11-14T22:13:20Z"));
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    EXPECT_GE(std::count(lines[i].begin(), lines[i].end(), ','),
              static_cast<long>(BillColumns().size()) - 1);
  }
}

}  // namespace
}  // namespace mortise::fabplanner
