#include "services/fabplanner/plan/bill_of_materials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/base/errors.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

TEST(BillOfMaterialsTest, MergesEqualSizesAndAddsUp) {
  const Items items = ExampleItems();
  const auto bill = MakeBill({{"items/dowel-8x35", {0.035, 0.008, 0.008}, 22},
                              {"items/leg-45", {2.4, 0.045, 0.045}, 1},
                              {"items/leg-45", {2.4, 0.045, 0.045}, 2},
                              {"items/leg-45", {2.4, 0.05, 0.05}, 1},
                              {"items/apron-20", {2.4, 0.09, 0.02}, 2}},
                             items);
  ASSERT_TRUE(bill.ok()) << bill.status();
  ASSERT_EQ(bill->lines.size(), 4);
  EXPECT_EQ(bill->lines[0].item, "items/apron-20");
  EXPECT_EQ(bill->lines[0].dimensions, "2400 × 90 × 20 mm");
  EXPECT_DOUBLE_EQ(bill->lines[0].unit_price.amount, 6.48);  // 1500 · 2.4 · 0.09 · 0.02
  EXPECT_DOUBLE_EQ(bill->lines[0].price.amount, 12.96);
  EXPECT_EQ(bill->lines[1].quantity, 3);
  EXPECT_DOUBLE_EQ(bill->lines[1].price.amount, 28.5);
  EXPECT_EQ(bill->lines[2].dimensions, "2400 × 50 × 50 mm");
  EXPECT_EQ(bill->lines[3].dimensions, "diameter 8 × 35 mm");
  EXPECT_DOUBLE_EQ(bill->lines[3].price.amount, 0.92);  // 22 · 0.042 = 0.924
  EXPECT_DOUBLE_EQ(bill->totals.at(0).amount, 12.96 + 28.5 + 9.5 + 0.92);
  EXPECT_EQ(bill->totals.at(0).currency, "EUR");
}

TEST(BillOfMaterialsTest, HasATotalOfEachCurrency) {
  Items items = ExampleItems();
  items["items/leg-45"].price.currency = "USD";
  const auto bill = MakeBill(
      {{"items/apron-20", {2.4, 0.09, 0.02}, 1}, {"items/leg-45", {2.4, 0.045, 0.045}, 2}}, items);
  ASSERT_TRUE(bill.ok()) << bill.status();
  ASSERT_EQ(bill->totals.size(), 2);
  EXPECT_EQ(bill->totals[0].currency, "EUR");
  EXPECT_DOUBLE_EQ(bill->totals[0].amount, 6.48);
  EXPECT_EQ(bill->totals[1].currency, "USD");
  EXPECT_DOUBLE_EQ(bill->totals[1].amount, 19);
}

TEST(BillOfMaterialsTest, APriceOfThePieceGoesBeforeThatOfTheItem) {
  const auto bill = MakeBill({{"items/leg-45", {3.0, 0.045, 0.045}, 2, 11.5}}, ExampleItems());
  ASSERT_TRUE(bill.ok()) << bill.status();
  EXPECT_DOUBLE_EQ(bill->lines[0].unit_price.amount, 11.5);
  EXPECT_DOUBLE_EQ(bill->lines[0].price.amount, 23);
}

TEST(BillOfMaterialsTest, ItemsWithoutAPriceAddNothing) {
  Items items = ExampleItems();
  items["items/leg-45"].price = {};
  const auto bill = MakeBill(
      {{"items/leg-45", {2.4, 0.045, 0.045}, 4}, {"items/plywood-18", {2.5, 1.25, 0.018}, 1}},
      items);
  ASSERT_TRUE(bill.ok()) << bill.status();
  EXPECT_EQ(bill->lines[0].price.currency, "");
  EXPECT_DOUBLE_EQ(bill->totals.at(0).amount, 89);
}

TEST(BillOfMaterialsTest, RefusesUnusableInput) {
  Items items = ExampleItems();
  const Eigen::Vector3d size(2.4, 0.045, 0.045);
  const auto code = [&](const Purchase& purchase) {
    return MakeBill({purchase}, items).status().code();
  };
  EXPECT_EQ(code({"items/none", size, 1}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({"items/leg-45", size, 0}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({"items/leg-45", -size, 1}), absl::StatusCode::kInvalidArgument);
  items["items/leg-45"].price.amount = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code({"items/leg-45", size, 1}), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace mortise::fabplanner
