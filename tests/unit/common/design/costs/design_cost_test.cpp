// What designs cost by the prices of their items.
#include "common/design/costs/design_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::parametric {
namespace {

Item MakeItem(const std::string& name, const std::string& currency, double price) {
  Item item;
  item.name = name;
  item.price = {currency, price};
  return item;
}

// A board of 2400 x 95 x 27 mm, cut to length.
Item Board(const std::string& currency = "EUR") {
  Item item = MakeItem("items/board", currency, 12);
  item.dimensions[0] = {.size = 2.4, .process = Process::kChopSaw, .minimum = 0.1, .maximum = 2.4};
  item.dimensions[1].size = 0.095;
  item.dimensions[2].size = 0.027;
  return item;
}

EvaluatedPart Part(const std::string& item, const Eigen::Vector3d& size) {
  EvaluatedPart part;
  part.name = "part of " + item;
  part.item = item;
  part.size = size;
  part.volume = size.prod();
  return part;
}

TEST(DesignCost, CountsTheShareOfThePiece) {
  EvaluatedDesign design;
  design.parts = {Part("items/board", {0.6, 0.095, 0.027}),
                  Part("items/board", {1.2, 0.095, 0.027})};
  const auto cost = CostOf(design, {Board()});
  ASSERT_TRUE(cost.ok()) << cost.status();
  EXPECT_EQ(cost->currency, "EUR");
  EXPECT_NEAR(cost->amount, 12 * (0.6 + 1.2) / 2.4, 1e-12);
}

TEST(DesignCost, CountsVolumesSheetsAndWholePieces) {
  Item sheet = MakeItem("items/sheet", "EUR", 60);
  sheet.dimensions[0] = {.size = 2.5, .process = Process::kJigsaw, .minimum = 0.05, .maximum = 2.5};
  sheet.dimensions[1] = {
      .size = 1.25, .process = Process::kJigsaw, .minimum = 0.05, .maximum = 1.25};
  Item timber = MakeItem("items/timber", "EUR", 800);
  timber.price_basis = PriceBasis::kPerVolume;
  const Item dowel = MakeItem("items/dowel", "EUR", 0.05);
  EvaluatedDesign design;
  design.parts = {Part("items/sheet", {0.5, 0.25, 0.018}), Part("items/timber", {1, 0.1, 0.1})};
  for (int i = 0; i < 4; ++i) {
    parametric::EvaluatedConnector peg;
    peg.connection = "row";
    peg.item = "items/dowel";
    peg.diameter = 0.008;
    peg.length = 0.035;
    design.connectors.push_back(peg);
  }
  const auto cost = CostOf(design, {sheet, timber, dowel});
  ASSERT_TRUE(cost.ok()) << cost.status();
  EXPECT_NEAR(cost->amount, 60 * 0.2 * 0.2 + 800 * 0.01 + 4 * 0.05, 1e-12);
}

TEST(DesignCost, SaysWhatHasNoPrice) {
  EvaluatedDesign design;
  design.parts = {Part("items/board", {1, 0.095, 0.027}), Part("", {1, 1, 1})};
  absl::Status status = CostOf(design, {Board()}).status();
  EXPECT_EQ(DetailOf(status).reason, "NO_PRICE");
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("no item"));
  design.parts.pop_back();
  status = CostOf(design, {Board("")}).status();
  EXPECT_EQ(DetailOf(status).reason, "NO_PRICE");
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("items/board"));
}

TEST(DesignCost, RefusesMixedCurrencies) {
  EvaluatedDesign design;
  design.parts = {Part("items/board", {1, 0.095, 0.027}), Part("items/hinge", {0.05, 0.05, 0.01})};
  const std::vector<Item> items{Board(), MakeItem("items/hinge", "USD", 3)};
  const absl::Status status = CostOf(design, items).status();
  EXPECT_EQ(DetailOf(status).reason, "MIXED_CURRENCIES");
  EXPECT_THAT(std::string(status.message()),
              ::testing::AllOf(::testing::HasSubstr("USD"), ::testing::HasSubstr("EUR")));
  EXPECT_EQ(CurrencyOf(items), "");
  EXPECT_EQ(CurrencyOf({Board(), MakeItem("items/free", "", 0)}), "EUR");
}

TEST(DesignNeeds, AreSharesOfPiecesByItem) {
  Item sheet = MakeItem("items/sheet", "", 0);
  sheet.dimensions[0] = {.size = 2.5, .process = Process::kJigsaw, .minimum = 0.05, .maximum = 2.5};
  sheet.dimensions[1] = {
      .size = 1.25, .process = Process::kJigsaw, .minimum = 0.05, .maximum = 1.25};
  EvaluatedDesign design;
  design.parts = {Part("items/sheet", {0.5, 0.25, 0.018}), Part("items/board", {0.6, 0.095, 0.027}),
                  Part("items/screw", {0.04, 0.004, 0.004}),
                  Part("items/board", {1.2, 0.095, 0.027}),
                  Part("items/screw", {0.04, 0.004, 0.004})};
  design.connectors.emplace_back();
  design.connectors.back().item = "items/screw";
  const auto needs = NeedsOf(design, {Board(), MakeItem("items/screw", "", 0), sheet});
  ASSERT_TRUE(needs.ok()) << needs.status();
  ASSERT_EQ(needs->size(), 3u);
  EXPECT_EQ((*needs)[0].item, "items/board");
  EXPECT_NEAR((*needs)[0].pieces, (0.6 + 1.2) / 2.4, 1e-12);
  EXPECT_EQ((*needs)[1].item, "items/screw");
  EXPECT_EQ((*needs)[1].pieces, 3);
  EXPECT_EQ((*needs)[2].item, "items/sheet");
  EXPECT_NEAR((*needs)[2].pieces, 0.2 * 0.2, 1e-12);
}

TEST(DesignNeeds, AreNotKnownOfPartsWithoutAnItem) {
  EvaluatedDesign design;
  design.parts = {Part("items/board", {0.6, 0.095, 0.027}), Part("", {1, 1, 1})};
  const absl::Status status = NeedsOf(design, {Board()}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(status).reason, "NO_ITEM");
}

// A longer table takes more wood.
TEST(DesignCost, OfTheShippedTable) {
  const auto table = templates::Compile(templates::ShippedTemplate("templates/table"));
  ASSERT_TRUE(table.ok()) << table.status();
  Eigen::VectorXd q = Defaults((*table)->parameters());
  double previous = 0;
  for (const double length : {1.2, 1.6, 2.0}) {
    q(0) = length;
    const auto design = (*table)->Evaluate(q);
    ASSERT_TRUE(design.ok()) << design.status();
    const auto cost = CostOf(*design, (*table)->head().items);
    ASSERT_TRUE(cost.ok()) << cost.status();
    EXPECT_GT(cost->amount, previous);
    previous = cost->amount;
  }
}

}  // namespace
}  // namespace mortise::parametric
