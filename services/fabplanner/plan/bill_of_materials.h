// Says what to buy: items with quantities, sizes to order and prices.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// So many pieces of an item in one size.
struct Purchase {
  std::string item;                                // name
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // m: length, width, thickness as ordered
  int quantity = 0;                                // pieces, > 0
  // The price of one piece, in the currency of the item's price; if there is none, the item's price
  // counts.
  std::optional<double> piece_price = {};
  bool is_unpriced = false;  // no price is known of this size
};

// Returns one line for each item and size (to a micrometre), boards first, then sheets, pegs,
// screws, bolts, nuts and other things, each by name. A line's price is the piece's times the
// quantity, rounded as money; a total is the sum of the lines of its currency. Items without a
// currency, and sizes of which no price is known, have none and add nothing. INVALID_ARGUMENT for
// unknown items or unusable numbers.
absl::StatusOr<Bill> MakeBill(const std::vector<Purchase>& purchases, const Items& items);

// Returns how many lines have no price, and are missing from the totals.
int UnpricedLines(const Bill& bill);

}  // namespace mortise::fabplanner
