// Any text given as CSV is taken apart into rows of equal width that can be written and read again,
// or is refused; and so it is with the items and materials in it.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "common/design/template_validation.h"
#include "common/files/csv_table.h"
#include "common/files/design_file.h"
#include "common/files/message_checks.h"

namespace {

std::string Written(const std::vector<mortise::parametric::CsvRow>& rows) {
  std::string text;
  for (const mortise::parametric::CsvRow& row : rows) {
    for (const mortise::parametric::CsvCell& cell : row) {
      text += cell.column == 1 ? "\"" : ",\"";
      for (const char c : cell.text) text += c == '"' ? "\"\"" : std::string(1, c);
      text += '"';
    }
    text += "\r\n";
  }
  return text;
}

void CheckTable(std::string_view text) {
  using namespace mortise::parametric;
  const CsvTable table = ParseCsv(text);
  const CsvTable again = ParseCsv(Written(table.rows));
  if (!again.findings.empty() || again.rows.size() != table.rows.size()) std::abort();
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (again.rows[i].size() != table.rows[0].size()) std::abort();
    for (std::size_t j = 0; j < table.rows[i].size(); ++j) {
      if (again.rows[i][j].text != table.rows[i][j].text) std::abort();
      if (table.rows[i][j].line < 1) std::abort();
    }
  }
}

// What makes no sense of a row has a place there, and has not been told already.
template <typename Message>
void CheckPlaces(const mortise::parametric::Placed<Message>& placed,
                 const std::vector<mortise::FieldViolation>& findings) {
  for (const mortise::FieldViolation& finding : findings) {
    if (mortise::parametric::PlaceOf(placed.place, placed.fields, finding.field).empty()) {
      std::abort();
    }
    if (placed.unread.count(finding.field) != 0) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::parametric;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  CheckTable(text);
  const DesignFile file = ParseDesignCsv(text);
  for (const Placed<mortise::v1::Material>& placed : file.materials) {
    CheckPlaces(placed, ValidateMaterialMessage(placed.message, placed.unread));
  }
  for (const Placed<mortise::v1::Item>& placed : file.items) {
    CheckPlaces(placed, ValidateItemMessage(placed.message, {}, placed.unread));
  }
  return 0;
}
