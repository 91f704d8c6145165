// A small bill as a tree to test its files with.
#pragma once

#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Two tables of which only the legs are told; the title looks like a formula.
inline BillTree SmallBill() {
  BillTree tree;
  tree.template_name = "templates/table";
  tree.template_revision = 3;
  tree.effective_from = 1'700'000'000;
  BillNode& table = tree.nodes.emplace_back();
  table.id = "1";
  table.kind = BillNodeKind::kAssembly;
  table.name = "templates/table";
  table.title = "=1+1";
  table.total_quantity = 2;
  table.size = {1.2, 0.7, 0.738};
  BillNode& leg = tree.nodes.emplace_back();
  leg.id = "1.1";
  leg.parent = 0;
  leg.name = "leg";
  leg.title = "Leg";
  leg.quantity = 4;
  leg.total_quantity = 8;
  leg.item = "items/leg";
  leg.item_revision = 5;
  leg.mass = 0.7;
  BillNode& board = tree.nodes.emplace_back();
  board.id = "1.1.1";
  board.parent = 1;
  board.kind = BillNodeKind::kStock;
  board.name = "items/leg";
  board.title = "Pine, planed";
  board.quantity = 0.375;
  board.total_quantity = 3;
  board.item = "items/leg";
  board.item_revision = 5;
  board.external_ids = {"P-1", "P-2"};
  board.size = {2.4, 0.045, 0.045};
  board.dimensions = "2400 × 45 × 45 mm";
  board.unit_price = {"EUR", 9.5};
  board.price = {"EUR", 28.5};
  return tree;
}

}  // namespace mortise::fabplanner
