// Writes cut list, bill of materials, parts and holes as comma-separated values (RFC 4180: CRLF,
// quotes where needed, UTF-8, decimal points). Lengths in millimetres, as the column names say.
// Texts that spreadsheets would run have a ' in front (text_escapes.h).
#pragma once

#include <string>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns a line for each part: its stock, process, part, position and size.
std::string CutListCsv(const FabricationPlan& plan);

// Returns a line for each item and size to buy, then for what is made to drawing, with material,
// mass of one piece and drawings; last a line with the total of each currency.
std::string BillCsv(const FabricationPlan& plan);

// Returns a line for each part of the design: how it is come by, of what, its size, what people do
// to it.
std::string PartsCsv(const FabricationPlan& plan, const Design& design);

// Returns a line for each hole: part, kind, diameter, depth, where its middle is, from the lower
// corner of the part's box as the part stands in the design, and where it goes.
std::string HolesCsv(const FabricationPlan& plan, const Design& design);

}  // namespace mortise::fabplanner
