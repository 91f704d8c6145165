// Computes what the material of a design costs by the prices of its items.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/design/metric.h"
#include "common/design/template_definition.h"

namespace mortise::simulator {

// Returns the sum over parts, those that only connect among them, and pegs. An item priced by
// volume costs that of the part; of one priced by the piece a part costs the share of the piece
// that it is long, and wide where that is cut too, and all of it where it is bought as it is.
// Waste, what is left of bars and sheets, work and parts made of no item are not in it; plans
// (fabplanner) count whole bars.
//
// FAILED_PRECONDITION, NO_PRICE, naming a part that is made of no item or of one without a price;
// MIXED_CURRENCIES naming two items.
absl::StatusOr<Cost> CostOf(const parametric::EvaluatedDesign& design,
                            const std::vector<parametric::Item>& items);

// Returns the currency of these items' prices; empty where none has one, or they have several.
std::string CurrencyOf(const std::vector<parametric::Item>& items);

}  // namespace mortise::simulator
