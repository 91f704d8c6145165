// Makes the bill as a tree: the whole, its sub-assemblies, their parts, and what these are cut
// from.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// What a plan is of, as the catalog knows it, and since when the plan holds.
struct BillSubject {
  std::string template_name;  // "templates/table"
  int64_t template_revision = 0;
  std::string title = {};
  std::vector<std::string> external_ids = {};
  std::string assembly = {};  // that the template is of; may be empty
  int64_t assembly_revision = 0;
  int64_t effective_from = 0;  // seconds since 1970, UTC
};

// Returns the tree of a plan that has its parts, its stock and its bill, and whose parts have all
// their drawings. Sub-assemblies come before parts, both in the design's order, pegs last; what has
// no part below it is left out. Parts of one sub-assembly that are alike, but for their holes, are
// one node with their names: same title, item, material, size, ends, outline and drawings.
//
// A board, sheet or plank that several parts are cut from is shared between them, with its trims,
// cuts and offcut, by length times width, so that the stock below the parts adds up to the pieces
// that are bought. Prices are shared alike, to the smallest amount of the currency: what remains
// goes to the largest remainders, first come. So leaves add up to the lines of the bill, in pieces
// and in money, and a node's price is the sum of those below it; where one of them has none, or
// another currency, it has none.
BillTree MakeBillTree(const FabricationPlan& plan, const Design& design, const Items& items,
                      const BillSubject& subject);

}  // namespace mortise::fabplanner
