// Reads comma-separated values as RFC 4180 describes them, strictly, and says where each cell was.
//
// Accepted beyond the RFC, because spreadsheets write it: a UTF-8 byte order mark at the beginning,
// lines that end with LF alone, and empty lines, also of commas only, which are left out.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {

// A cell without the quotes around it, and where it begins.
struct CsvCell {
  std::string text;
  int line = 0;    // of the file, from 1; rows with line breaks inside quotes take several lines
  int column = 0;  // of the row, from 1: first cell, second cell …
};

// The cells of a row; never empty.
using CsvRow = std::vector<CsvCell>;

struct CsvTable {
  std::vector<CsvRow> rows;    // the first is the header, if there is one
  std::vector<CsvRow> ragged;  // whose number of cells is not that of the first, which is told
  // What is wrong, with places such as "line 7, column 3" as fields; at most 100. Rows at fault are
  // not among the rows.
  std::vector<FieldViolation> findings;
  std::size_t unlisted = 0;  // findings beyond those
};

// Faults: a quote inside a cell that does not begin with one, something between a closing quote and
// the next comma, a quote that is never closed, a carriage return outside quotes without a line
// feed, a NUL, bytes that are not UTF-8, and rows whose number of cells is not that of the first.
CsvTable ParseCsv(std::string_view text);

// Returns what separates cells of `text`, by its first line, if it is no comma: "semicolons". Empty
// for commas.
std::string OtherSeparator(std::string_view text);

// Returns a cell as a finite number with a decimal point, "12.5" or "1.25e1". With `thousandths`,
// the number nearest to a thousandth of it: "6.8" is 0.0068. INVALID_ARGUMENT otherwise, without a
// field.
absl::StatusOr<double> ParseCsvNumber(const std::string& text, bool thousandths = false);

// "line 7, column 3": the place of a cell.
std::string PlaceOf(const CsvCell& cell);

}  // namespace mortise::parametric
