#include "services/fabplanner/cutting/stock_cutting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>

#include "common/base/errors.h"
#include "services/fabplanner/planning/part_making.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Outcome {
  absl::Status status;
  FabricationPlan plan;
  std::vector<Purchase> purchases;
};

Outcome Cut(const std::vector<Part>& parts, const Items& items) {
  Design design;
  design.parts = parts;
  Outcome outcome;
  const auto planned = PlanParts(design, items);
  EXPECT_TRUE(planned.ok()) << planned.status();
  outcome.plan.parts = *planned;
  outcome.status = CutParts(design, items, &outcome.plan, &outcome.purchases);
  return outcome;
}

Part Strip(const std::string& name, double length, double width = 0.09) {
  return BoxPart(name, "items/apron-20", CutProcess::kChopSaw, {0, 0, 0}, {length, width, 0.02}, 0,
                 2);
}

Part Panel(const std::string& name, double length, double width) {
  return BoxPart(name, "items/plywood-18", CutProcess::kJigsaw, {0, 0, 0}, {length, width, 0.018},
                 0, 2);
}

TEST(StockCuttingTest, TakesTheLengthsThatCostLeast) {
  Items items = ExampleItems();
  items["items/apron-20"].price_per_volume = false;
  items["items/apron-20"].stock = {{1.2, 0, 3}, {2.4, 0, 5.5}, {3, 0, 8}};
  const Outcome outcome = Cut({Strip("a", 1.1), Strip("b", 1.1), Strip("c", 1.1)}, items);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status;
  ASSERT_EQ(outcome.purchases.size(), 2);  // one of 1.2 m and one of 2.4 m
  EXPECT_DOUBLE_EQ(outcome.purchases[0].size.x(), 1.2);
  EXPECT_DOUBLE_EQ(outcome.purchases[0].piece_price.value(), 3);
  EXPECT_DOUBLE_EQ(outcome.purchases[1].size.x(), 2.4);
  EXPECT_DOUBLE_EQ(outcome.purchases[1].piece_price.value(), 5.5);
  EXPECT_EQ(outcome.plan.boards.size(), 2);
  EXPECT_EQ(outcome.plan.chop_saw_parts, 3);
}

TEST(StockCuttingTest, TheOnlySizeHasItsOwnPrice) {
  Items items = ExampleItems();
  Item& plank = items["items/apron-20"];
  plank.price_per_volume = false;
  plank.price.amount = 9.5;
  plank.stock = {{3, 0, 12}};
  EXPECT_DOUBLE_EQ(Cut({Strip("a", 2.5)}, items).purchases.at(0).piece_price.value(), 12);
}

TEST(StockCuttingTest, ASizeWithoutAPriceHasNone) {
  Items items = ExampleItems();
  Item& plank = items["items/apron-20"];
  plank.price_per_volume = false;
  plank.price.amount = 9.5;
  plank.stock = {{3, 0, std::nullopt}};
  Purchase purchase = Cut({Strip("a", 2.5)}, items).purchases.at(0);
  EXPECT_TRUE(purchase.is_unpriced);
  auto bill = MakeBill({purchase}, items);
  ASSERT_TRUE(bill.ok()) << bill.status();
  EXPECT_EQ(bill->lines[0].price.currency, "");
  EXPECT_EQ(UnpricedLines(*bill), 1);
  EXPECT_TRUE(bill->totals.empty());
  // The size that the item is described by has the item's price.
  plank.stock = {{2.4, 0, std::nullopt}, {3, 0, 12}};
  purchase = Cut({Strip("a", 2.3)}, items).purchases.at(0);
  EXPECT_FALSE(purchase.is_unpriced);
  bill = MakeBill({purchase}, items);
  ASSERT_TRUE(bill.ok()) << bill.status();
  EXPECT_DOUBLE_EQ(bill->lines[0].price.amount, 9.5);
  // One that is free is the cheapest, and its price is 0.
  plank.stock = {{2.4, 0, 9.5}, {3, 0, 0.0}};
  purchase = Cut({Strip("a", 2.3)}, items).purchases.at(0);
  EXPECT_DOUBLE_EQ(purchase.size.x(), 3);
  bill = MakeBill({purchase}, items);
  ASSERT_TRUE(bill.ok()) << bill.status();
  EXPECT_DOUBLE_EQ(bill->lines[0].price.amount, 0);
  EXPECT_EQ(bill->lines[0].price.currency, "EUR");
  EXPECT_EQ(UnpricedLines(*bill), 0);
}

TEST(StockCuttingTest, StripsOfDifferentWidthsShareAPlank) {
  Items items = ExampleItems();
  Item& plank = items["items/apron-20"];
  plank.size.y() = 0.089;
  plank.ripped = true;
  plank.price_per_volume = false;
  const Outcome outcome = Cut({Strip("a", 2.3, 0.04), Strip("b", 2.3, 0.045)}, items);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status;
  ASSERT_EQ(outcome.purchases.size(), 1);
  EXPECT_EQ(outcome.purchases[0].quantity, 1);
  ASSERT_EQ(outcome.plan.boards.size(), 2);
  EXPECT_EQ(outcome.plan.boards[0].plank, "plank-1");
  EXPECT_EQ(outcome.plan.boards[1].plank, "plank-1");
  EXPECT_DOUBLE_EQ(
      std::abs(outcome.plan.boards[0].plank_position - outcome.plan.boards[1].plank_position),
      outcome.plan.boards[0].plank_position == 0 ? 0.043 : 0.048);
  EXPECT_THAT(outcome.plan.handwork,
              ElementsAre(HasSubstr("1 board of Planed pine 20 × 90 to 1 strip 40 mm wide and 1 "
                                    "strip 45 mm wide")));
}

TEST(StockCuttingTest, SheetsWithoutGrainAreTurned) {
  Items items = ExampleItems();
  items["items/plywood-18"].size = {2, 1, 0.018};
  const std::vector<Part> parts = {Panel("a", 0.98, 0.65), Panel("b", 0.98, 0.65),
                                   Panel("c", 0.98, 0.65)};
  EXPECT_EQ(Cut(parts, items).plan.sheets.size(), 2);
  items["items/plywood-18"].has_grain = false;
  EXPECT_EQ(Cut(parts, items).plan.sheets.size(), 1);
  // Fits only when it is turned.
  EXPECT_TRUE(Cut({Panel("a", 0.65, 1.5)}, items).status.ok());
  items["items/plywood-18"].has_grain = true;
  EXPECT_THAT(std::string(Cut({Panel("a", 0.65, 1.5)}, items).status.message()),
              HasSubstr("may not be turned"));
}

TEST(StockCuttingTest, BoardsThatAreRippedAreBoughtWhole) {
  Items items = ExampleItems();
  Item& plank = items["items/apron-20"];
  plank.size.y() = 0.2;
  plank.ripped = true;
  plank.price_per_volume = false;
  // Two strips of 98 mm and a kerf of 3 mm fit 200 mm; three boards' worth of strips take two.
  const Outcome outcome =
      Cut({Strip("a", 2, 0.098), Strip("b", 2, 0.098), Strip("c", 2, 0.098)}, items);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status;
  EXPECT_EQ(outcome.plan.boards.size(), 3);
  EXPECT_DOUBLE_EQ(outcome.plan.boards[0].width, 0.098);
  ASSERT_EQ(outcome.purchases.size(), 1);
  EXPECT_EQ(outcome.purchases[0].quantity, 2);
  EXPECT_DOUBLE_EQ(outcome.purchases[0].size.y(), 0.2);
  EXPECT_THAT(outcome.plan.handwork,
              ElementsAre(AllOf(HasSubstr("rip 2 boards"), HasSubstr("3 strips 98 mm wide"))));
}

TEST(StockCuttingTest, TakesTheSmallestSheetThatHoldsWhatIsOnIt) {
  Items items = ExampleItems();
  items["items/plywood-18"].stock = {{2.44, 1.22, 60}, {1.22, 1.22, 32}, {1.22, 0.61, 17}};
  Outcome outcome = Cut({Panel("a", 1, 0.5)}, items);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status;
  ASSERT_EQ(outcome.plan.sheets.size(), 1);
  EXPECT_DOUBLE_EQ(outcome.plan.sheets[0].width, 0.61);
  EXPECT_DOUBLE_EQ(outcome.purchases[0].piece_price.value(), 17);

  // Two large panels fill a large sheet each; what is left over takes a small one.
  outcome = Cut({Panel("a", 2.2, 1.1), Panel("b", 2.2, 1.1), Panel("c", 1, 0.5)}, items);
  ASSERT_TRUE(outcome.status.ok()) << outcome.status;
  std::map<double, int> by_price;
  std::map<std::string, int> placed;
  for (const Purchase& purchase : outcome.purchases) ++by_price[purchase.piece_price.value()];
  for (const SheetLayout& sheet : outcome.plan.sheets) {
    for (const SheetPlacement& placement : sheet.placements) {
      ++placed[placement.part];
      for (const Eigen::Vector2d& point : placement.outline) {
        EXPECT_GE(point.minCoeff(), 0);
        EXPECT_LE(point.x(), sheet.length);
        EXPECT_LE(point.y(), sheet.width);
      }
    }
  }
  EXPECT_EQ(by_price, (std::map<double, int>{{60, 2}, {17, 1}}));
  EXPECT_EQ(placed, (std::map<std::string, int>{{"a", 1}, {"b", 1}, {"c", 1}}));
}

TEST(StockCuttingTest, NamesPartItemAndSizesWhereNoStockYieldsThem) {
  const Outcome boards = Cut({Strip("rail", 2.5)}, ExampleItems());
  EXPECT_EQ(DetailOf(boards.status).reason, "PART_TOO_LONG");
  EXPECT_THAT(std::string(boards.status.message()),
              AllOf(HasSubstr("rail"), HasSubstr("2500 mm"), HasSubstr("2400 mm"),
                    HasSubstr("items/apron-20")));
  const Outcome sheets = Cut({Panel("top", 2.6, 1)}, ExampleItems());
  EXPECT_EQ(DetailOf(sheets.status).reason, "PART_TOO_LARGE");
  EXPECT_THAT(std::string(sheets.status.message()),
              AllOf(HasSubstr("top"), HasSubstr("2600"), HasSubstr("items/plywood-18")));
}

}  // namespace
}  // namespace mortise::fabplanner
