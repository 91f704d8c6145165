// What designs are made of, and what that costs, line by line.
#include "common/design/costs/design_bill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mortise::parametric {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A board of 2.4 m, cut to length, at 12 EUR.
Item Board() {
  Item item;
  item.name = "items/board";
  item.kind = ItemKind::kBoard;
  item.price = {"EUR", 12};
  item.dimensions[0] = {.size = 2.4, .process = Process::kChopSaw, .minimum = 0.1, .maximum = 2.4};
  return item;
}

Item Screw(const std::string& currency) {
  Item item;
  item.name = "items/screw";
  item.kind = ItemKind::kScrew;
  item.price = {currency, 0.05};
  return item;
}

EvaluatedPart Part(const std::string& name, const std::string& item, double length) {
  EvaluatedPart part;
  part.name = name;
  part.item = item;
  part.size = {length, 0.095, 0.027};
  part.volume = part.size.prod();
  return part;
}

EvaluatedDesign Shelf() {
  EvaluatedDesign design;
  design.parts = {Part("screw 1", "items/screw", 0.04), Part("side 1", "items/board", 1.2),
                  Part("shelf", "items/board", 0.6), Part("side 2", "items/board", 1.2 + 1e-10),
                  Part("screw 2", "items/screw", 0.04)};
  return design;
}

TEST(DesignBill, HasALineForEachItemAndSize) {
  const DesignBill bill = BillOf(Shelf(), {Board(), Screw("EUR")});
  ASSERT_THAT(bill.lines, SizeIs(3));
  EXPECT_EQ(bill.lines[0].item, "items/board");
  EXPECT_THAT(bill.lines[0].parts, ElementsAre("shelf"));
  EXPECT_NEAR(bill.lines[0].piece_price.amount, 3, 1e-12);
  EXPECT_THAT(bill.lines[1].parts, ElementsAre("side 1", "side 2"));
  EXPECT_EQ(bill.lines[1].quantity, 2);
  EXPECT_NEAR(bill.lines[1].size.x(), 1.2, 1e-9);
  EXPECT_NEAR(bill.lines[1].price.amount, 12, 1e-8);
  EXPECT_EQ(bill.lines[2].item, "items/screw");
  EXPECT_EQ(bill.lines[2].quantity, 2);
  EXPECT_EQ(bill.unpriced, 0);
}

TEST(DesignBill, AddsUpToTheCost) {
  const std::vector<Item> items{Board(), Screw("EUR")};
  const DesignBill bill = BillOf(Shelf(), items);
  ASSERT_THAT(bill.totals, SizeIs(1));
  EXPECT_EQ(bill.totals[0].currency, "EUR");
  EXPECT_NEAR(bill.totals[0].amount, CostOf(Shelf(), items)->amount, 1e-12);
}

TEST(DesignBill, AddsUpEachCurrencyByItself) {
  const DesignBill bill = BillOf(Shelf(), {Board(), Screw("USD")});
  ASSERT_THAT(bill.totals, SizeIs(2));
  EXPECT_NEAR(bill.totals[1].amount, 0.1, 1e-12);
  EXPECT_EQ(bill.totals[1].currency, "USD");
}

TEST(DesignBill, TellsWhatHasNoPrice) {
  EvaluatedDesign design = Shelf();
  design.parts.push_back(Part("handle", "", 0.1));
  const DesignBill bill = BillOf(design, {Board()});
  EXPECT_EQ(bill.unpriced, 2);
  ASSERT_THAT(bill.lines, SizeIs(4));
  EXPECT_EQ(bill.lines[2].item, "items/screw");
  EXPECT_THAT(bill.lines[2].price.currency, IsEmpty());
  EXPECT_THAT(bill.lines[3].parts, ElementsAre("handle"));
  EXPECT_THAT(BillOf({}, {}).lines, IsEmpty());
}

TEST(DesignBill, CountsPegs) {
  EvaluatedDesign design;
  for (int i = 0; i < 4; ++i) {
    EvaluatedConnector peg;
    peg.connection = "row";
    peg.item = "items/screw";
    peg.diameter = 0.008;
    peg.length = 0.035;
    design.connectors.push_back(peg);
  }
  const DesignBill bill = BillOf(design, {Screw("EUR")});
  ASSERT_THAT(bill.lines, SizeIs(1));
  EXPECT_EQ(bill.lines[0].quantity, 4);
  EXPECT_THAT(bill.lines[0].parts, ElementsAre("row"));
  EXPECT_NEAR(bill.lines[0].price.amount, 0.2, 1e-12);
}

}  // namespace
}  // namespace mortise::parametric
