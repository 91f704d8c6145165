// Writes items as comma-separated values, in the form that design_file.h reads.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "mortise/v1/item.pb.h"

namespace mortise::parametric {

// Returns a table with a header and a row for each item (docs/catalogue.md has the columns),
// lengths in m, for spreadsheets as well: UTF-8 with the mark by which they know it, lines that end
// with CR LF, and texts that they would run with a ' in front. Columns that few items need are
// there where one has something in them. ParseDesignCsv reads the same items of it, but for what
// the service sets.
//
// FAILED_PRECONDITION, NOT_IN_CSV, naming the item: external ids, labels and suppliers with a
// separator of lists in cells, or with space around them, which would be read as something else.
absl::StatusOr<std::string> ItemsAsCsv(const std::vector<v1::Item>& items);

}  // namespace mortise::parametric
