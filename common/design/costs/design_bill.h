// The bill of materials of a design: what is in it, item by item and size by size, with prices.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/design/costs/design_cost.h"

namespace mortise::parametric {

// Parts of one item in one size.
struct BillLine {
  std::string item;  // items/{id}; empty for what no item is
  Eigen::Vector3d size =
      Eigen::Vector3d::Zero();     // m, in the item's axes: length, width, thickness
  std::vector<std::string> parts;  // names; pegs by their connection, once
  int quantity = 0;                // > 0
  Cost piece_price;                // of the first; no currency where no price is known
  Cost price;                      // of all of them; likewise
};

struct DesignBill {
  std::vector<BillLine> lines;  // by kind of item, then name and size; what no item is comes last
  std::vector<Cost> totals;     // of the lines that have prices, by currency
  int unpriced = 0;             // lines without one
};

// Returns what the parts, those that only connect among them, and the pegs of a design are made of.
// Sizes are alike within a micrometre. Prices are those of CostOf: of what is cut from a bar or
// sheet the share of it, without waste; where all parts have prices in one currency, the total is
// CostOf's. Of items that are not among `items` no price is known.
DesignBill BillOf(const EvaluatedDesign& design, const std::vector<Item>& items);

}  // namespace mortise::parametric
