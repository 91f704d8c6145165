// The metrics that every design has, by name and unit, for those who check what is written about
// them; the simulator computes them.
#pragma once

#include <vector>

#include "common/expressions/metric_expressions.h"

namespace mortise::parametric {

// Returns the metrics in the order of the manual. The cost is in the currency of the items: its
// unit is empty.
const std::vector<NamedUnit>& DesignMetrics();

}  // namespace mortise::parametric
