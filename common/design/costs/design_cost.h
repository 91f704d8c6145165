// What a design takes of its items, and what that costs by their prices.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/design/metric.h"
#include "common/design/template_definition.h"

namespace mortise::parametric {

using simulator::Cost;

// So much of an item, as a design needs it.
struct ItemNeed {
  std::string item;   // items/{id}
  double pieces = 0;  // as sold, > 0: of what is cut the share of a piece, by length and width
};

// Returns what the parts, those that only connect among them, and the pegs of a design take, each
// item once, by name. Waste is not in it, as of CostOf. FAILED_PRECONDITION, NO_ITEM, naming a part
// that is made of no item, or of one that is not among `items`.
absl::StatusOr<std::vector<ItemNeed>> NeedsOf(const EvaluatedDesign& design,
                                              const std::vector<Item>& items);

// Returns what a part of this size, m, in the item's axes and volume, m³, costs by the price of its
// item, as CostOf counts it. The currency is empty where the item has no price.
Cost PartCost(const Item& item, const Eigen::Vector3d& size, double volume);

// Returns the sum over parts, those that only connect among them, and pegs. An item priced by
// volume costs that of the part; of one priced by the piece a part costs the share of the piece
// that it is long, and wide where that is cut too, and all of it where it is bought as it is.
// Waste, what is left of bars and sheets, work and parts made of no item are not in it; plans
// (fabplanner) count whole bars.
//
// FAILED_PRECONDITION, NO_PRICE, naming a part that is made of no item or of one without a price;
// MIXED_CURRENCIES naming two items.
absl::StatusOr<Cost> CostOf(const EvaluatedDesign& design, const std::vector<Item>& items);

// Returns the currency of these items' prices; empty where none has one, or they have several.
std::string CurrencyOf(const std::vector<Item>& items);

}  // namespace mortise::parametric
