// Holds a bill as a tree against the bill of its plan.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <string>

#include "services/fabplanner/plan/money.h"
#include "services/fabplanner/plan/plan.h"
#include "services/fabplanner/planning/stock_shares.h"

namespace mortise::fabplanner {

// Expects that each line of the bill is the sum of its leaves, in pieces and in money to the
// smallest amount; that a node costs what is below it costs; and that there are as many of it as it
// says.
inline void ExpectTreeAddsUp(const FabricationPlan& plan, const std::string& name) {
  const std::vector<BillNode>& nodes = plan.bill_tree.nodes;
  ASSERT_FALSE(nodes.empty()) << name;
  std::vector<double> below(nodes.size());  // smallest amounts
  std::vector<bool> has_children(nodes.size());
  std::map<Ware, double> pieces, units;
  double drawn = 0;
  std::set<std::string> ids, parts;
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const BillNode& node = nodes[i];
    EXPECT_TRUE(ids.insert(node.id).second) << name << ": " << node.id;
    for (const std::string& part : node.parts) EXPECT_TRUE(parts.insert(part).second) << part;
    ASSERT_LT(node.parent, static_cast<int>(i)) << name;
    if (has_children[i] && !node.price.currency.empty()) {
      EXPECT_EQ(MinorUnits(node.price), below[i]) << name << ": " << node.id;
    }
    if (!has_children[i]) {
      if (node.kind == BillNodeKind::kPart) {
        drawn += node.total_quantity;
      } else {
        pieces[WareOf(node.item, node.size)] += node.total_quantity;
        units[WareOf(node.item, node.size)] += MinorUnits(node.price);
      }
    }
    if (node.parent < 0) continue;
    const auto parent = static_cast<std::size_t>(node.parent);
    has_children[parent] = true;
    below[parent] += MinorUnits(node.price);
    EXPECT_NEAR(node.total_quantity, node.quantity * nodes[parent].total_quantity, 1e-9) << name;
  }
  EXPECT_EQ(parts.size(), plan.parts.size()) << name;
  for (const BillLine& line : plan.bill.lines) {
    if (line.item.empty()) {
      drawn -= line.quantity;
      continue;
    }
    const Ware ware = WareOf(line.item, line.size);
    EXPECT_NEAR(pieces[ware], line.quantity, 1e-6) << name << ": " << line.title;
    EXPECT_EQ(units[ware], MinorUnits(line.price)) << name << ": " << line.title;
    pieces.erase(ware);
  }
  EXPECT_TRUE(pieces.empty()) << name;
  EXPECT_EQ(drawn, 0) << name;
}

}  // namespace mortise::fabplanner
