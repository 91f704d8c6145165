// Cut list and bill of materials as comma-separated values (RFC 4180: CRLF, quotes where needed,
// UTF-8, decimal points). Lengths in millimetres, as the column names say.
#pragma once

#include <string>

#include "services/fabplanner/plan.h"

namespace mortise::fabplanner {

// A line for each part: its stock, process, part, position and size.
std::string CutListCsv(const FabricationPlan& plan);

// A line for each item and size to buy, and a last line with the total.
std::string BillCsv(const FabricationPlan& plan);

}  // namespace mortise::fabplanner
