// The bill as a tree, as a table: what its files have in common, and the table as text.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// A cell: nothing, a text, a number, or an amount of money, whose currency has a column of its own.
using BillCell = std::variant<std::monostate, std::string, double, Money>;

struct BillColumn {
  const char* name;  // with its unit: "mass_kg"
  double width;      // in characters
};

struct BillRow {
  int level = 0;  // 0 for the whole
  std::vector<BillCell> cells;
};

// Returns the columns, and a row for each node in the order of the tree, with a cell for each
// column.
const std::vector<BillColumn>& BillColumns();
std::vector<BillRow> BillRows(const BillTree& tree);

// Returns the table as comma-separated values (RFC 4180): lengths in m, amounts with the decimals
// of their currency, lists with ";" between their entries, texts that spreadsheets would run with a
// ' in front.
std::string BillTreeCsv(const BillTree& tree);

// Returns the moment in UTC as ISO 8601 writes it: "2026-11-26T20:25:30Z".
std::string EffectivityText(int64_t seconds);

}  // namespace mortise::fabplanner
