// Writes a row of comma-separated values. Private to this folder.
#pragma once

#include <string>
#include <vector>

#include "common/base/text_escapes.h"

namespace mortise::fabplanner {

// Appends the row, which ends with CR LF: quotes where RFC 4180 needs them, and a ' before texts
// that spreadsheets would run.
inline void AppendCsvRow(const std::vector<std::string>& fields, std::string* csv) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i > 0) csv->push_back(',');
    csv->append(CsvField(SpreadsheetText(fields[i])));
  }
  csv->append("\r\n");
}

}  // namespace mortise::fabplanner
