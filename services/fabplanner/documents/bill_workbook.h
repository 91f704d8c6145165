// The bill as a tree, as a workbook that spreadsheets open (Office Open XML).
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// Returns the bytes of an XLSX file with one sheet, "Bill": the columns of BillColumns, a row a
// node. Numbers are numbers, amounts of money have the decimals of their currency, and texts are
// texts, whatever they begin with; those of more than 32767 characters, which no cell holds, are
// cut off with "…". The header stays in view, and rows can be folded by the level of their nodes,
// of which spreadsheets know seven. `title` is that of the design. The same tree gives the same
// bytes: the file counts as made when the tree takes effect. INTERNAL where it cannot be written.
absl::StatusOr<std::string> BillWorkbook(const BillTree& tree, const std::string& title);

}  // namespace mortise::fabplanner
