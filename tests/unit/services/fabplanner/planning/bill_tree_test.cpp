#include "services/fabplanner/planning/bill_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/fabplanner/documents/plan_files.h"
#include "services/fabplanner/plan/bill_of_materials.h"
#include "services/fabplanner/planning/planning.h"
#include "tests/unit/services/fabplanner/added_bill.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;

FabricationPlan PlanWithTree(const Design& design, const Items& items, int quantity) {
  absl::StatusOr<FabricationPlan> plan = MakePlan(design, items, quantity);
  EXPECT_TRUE(plan.ok()) << plan.status();
  if (!plan.ok()) return {};
  plan->bill_tree = MakeBillTree(*plan, design, items,
                                 {.template_name = "templates/table",
                                  .template_revision = 3,
                                  .title = "Table",
                                  .external_ids = {"100-4711/A"},
                                  .effective_from = 1'700'000'000});
  return *std::move(plan);
}

// The table as people draw it, with alike legs called alike.
Design TitledTable() {
  Design table = ExampleTable();
  for (std::size_t i = 0; i < 4; ++i) table.parts[i].title = "Leg";
  return table;
}

const BillNode* NodeCalled(const BillTree& tree, const std::string& name) {
  for (const BillNode& node : tree.nodes) {
    if (node.name == name) return &node;
  }
  ADD_FAILURE() << "no node " << name;
  return nullptr;
}

TEST(BillTreeTest, LeavesAddUpToTheLinesOfTheBill) {
  for (const int quantity : {1, 2, 7}) {
    const FabricationPlan table = PlanWithTree(TitledTable(), ExampleItems(), quantity);
    ExpectTreeAddsUp(table, "table");
    ASSERT_FALSE(table.bill_tree.nodes.empty());
    EXPECT_EQ(MinorUnits(table.bill_tree.nodes[0].price), MinorUnits(table.bill.totals.at(0)));
    ExpectTreeAddsUp(PlanWithTree(ExampleRack(), ExampleItems(), quantity), "rack");
  }
}

TEST(BillTreeTest, AlikePartsAreOneNodeWithWhatTheyAreCutFrom) {
  Items items = ExampleItems();
  items["items/leg-45"].revision = 5;
  items["items/leg-45"].external_ids = {"P-1"};
  const FabricationPlan plan = PlanWithTree(TitledTable(), items, 2);
  const BillTree& tree = plan.bill_tree;
  ASSERT_GE(tree.nodes.size(), 3u);
  EXPECT_EQ(tree.nodes[0].id, "1");
  EXPECT_EQ(tree.nodes[0].kind, BillNodeKind::kAssembly);
  EXPECT_EQ(tree.nodes[0].title, "Table");
  EXPECT_EQ(tree.nodes[0].total_quantity, 2);
  EXPECT_THAT(tree.nodes[0].external_ids, ElementsAre("100-4711/A"));
  EXPECT_EQ(tree.nodes[0].dimensions, "1300 × 800 × 738 mm");
  const BillNode& leg = tree.nodes[1];
  EXPECT_EQ(leg.id, "1.1");
  EXPECT_EQ(leg.kind, BillNodeKind::kPart);
  EXPECT_EQ(leg.quantity, 4);
  EXPECT_EQ(leg.total_quantity, 8);
  EXPECT_THAT(leg.parts, ElementsAre("leg_1", "leg_2", "leg_3", "leg_4"));
  EXPECT_TRUE(leg.size.isApprox(Eigen::Vector3d(0.72, 0.045, 0.045)));
  EXPECT_THAT(leg.artifacts, Contains("boards.svg"));
  EXPECT_THAT(leg.artifacts, Contains("holes.csv"));
  EXPECT_TRUE(leg.external_ids.empty());
  // Eight legs of 720 mm take three boards of 2400 mm, which nothing else is cut from.
  const BillNode& board = tree.nodes[2];
  EXPECT_EQ(board.id, "1.1.1");
  EXPECT_EQ(board.parent, 1);
  EXPECT_EQ(board.kind, BillNodeKind::kStock);
  EXPECT_EQ(board.item, "items/leg-45");
  EXPECT_EQ(board.item_revision, 5);
  EXPECT_THAT(board.external_ids, ElementsAre("P-1"));
  EXPECT_NEAR(board.total_quantity, 3, 1e-9);
  EXPECT_NEAR(board.quantity, 3.0 / 8, 1e-9);
  EXPECT_EQ(board.price.amount, 28.5);
  EXPECT_EQ(leg.price.amount, 28.5);
  EXPECT_EQ(board.unit_price.amount, 9.5);
}

TEST(BillTreeTest, PegsAndScrewsAreBoughtByThePiece) {
  const FabricationPlan table = PlanWithTree(ExampleTable(), ExampleItems(), 1);
  const BillNode& pegs = table.bill_tree.nodes.back();
  EXPECT_EQ(pegs.kind, BillNodeKind::kBought);
  EXPECT_EQ(pegs.item, "items/dowel-8x35");
  EXPECT_EQ(pegs.quantity, 22);
  EXPECT_EQ(pegs.price.amount, 0.92);
  EXPECT_EQ(pegs.unit_price.amount, 0.04);
  EXPECT_FALSE(pegs.mass.has_value());
  EXPECT_THAT(pegs.artifacts, Contains("step-1.png"));
}

TEST(BillTreeTest, SubAssembliesHoldTheirParts) {
  Design rack = ExampleRack();
  rack.groups.push_back({"shelves", 0});
  rack.groups.push_back({"empty", 0});
  for (Part& part : rack.parts) {
    if (part.name.starts_with("shelf")) part.group = 1;
  }
  const FabricationPlan plan = PlanWithTree(rack, ExampleItems(), 3);
  ExpectTreeAddsUp(plan, "rack");
  const BillNode* shelves = NodeCalled(plan.bill_tree, "shelves");
  ASSERT_NE(shelves, nullptr);
  EXPECT_EQ(shelves->id, "1.1");
  EXPECT_EQ(shelves->kind, BillNodeKind::kSubAssembly);
  EXPECT_EQ(shelves->total_quantity, 3);
  for (const BillNode& node : plan.bill_tree.nodes) EXPECT_NE(node.name, "empty");
  const BillNode* shelf = NodeCalled(plan.bill_tree, "shelf 1");
  ASSERT_NE(shelf, nullptr);
  EXPECT_EQ(plan.bill_tree.nodes[static_cast<std::size_t>(shelf->parent)].name, "shelves");
}

TEST(BillTreeTest, WhatHoldsSomethingWithoutAPriceHasNone) {
  Items items = ExampleItems();
  items["items/plywood-18"].price = {};
  const FabricationPlan plan = PlanWithTree(TitledTable(), items, 1);
  ExpectTreeAddsUp(plan, "table");
  ASSERT_FALSE(plan.bill_tree.nodes.empty());
  EXPECT_EQ(plan.bill_tree.nodes[0].price.currency, "");
  EXPECT_EQ(NodeCalled(plan.bill_tree, "top")->price.currency, "");
  EXPECT_EQ(NodeCalled(plan.bill_tree, "leg_1")->price.currency, "EUR");
}

TEST(BillTreeTest, PricesAreSharedToTheSmallestAmountOfTheirCurrency) {
  Items items = ExampleItems();
  for (auto& [name, item] : items) item.price.currency = "JPY";
  items["items/plywood-18"].price.amount = 1001;
  const FabricationPlan plan = PlanWithTree(ExampleRack(), items, 1);
  ExpectTreeAddsUp(plan, "rack");
  for (const BillNode& node : plan.bill_tree.nodes) {
    EXPECT_EQ(node.price.amount, std::floor(node.price.amount)) << node.id;
  }
}

TEST(BillTreeTest, FilesAreThoseOfThePlan) {
  for (const Design& design : {ExampleTable(), ExampleRack()}) {
    const FabricationPlan plan = PlanWithTree(design, ExampleItems(), 1);
    const auto files = MakePlanFiles(plan, design, ExampleItems(), {"Design", "plans/1"},
                                     [](int, int) { return true; });
    ASSERT_TRUE(files.ok()) << files.status();
    std::set<std::string> names;
    for (const PlanFile& file : *files) names.insert(file.file_name);
    for (const BillNode& node : plan.bill_tree.nodes) {
      EXPECT_FALSE(node.artifacts.empty()) << node.id;
      for (const std::string& file : node.artifacts) EXPECT_TRUE(names.contains(file)) << file;
    }
  }
}

}  // namespace
}  // namespace mortise::fabplanner
