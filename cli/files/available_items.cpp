#include "cli/files/available_items.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/client/requests.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/files/csv_table.h"

namespace mortise::cli {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{4} << 20;

// The column of the header that is called so.
std::optional<std::size_t> ColumnOf(const parametric::CsvRow& header, std::string_view name) {
  const auto found =
      std::find_if(header.begin(), header.end(),
                   [name](const parametric::CsvCell& cell) { return cell.text == name; });
  if (found == header.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header.begin());
}

// Takes an item with the text of its quantity; empty for as many as it takes.
absl::StatusOr<v1::AvailableItem> Available(const std::string& item, const std::string& quantity) {
  v1::AvailableItem available;
  available.set_item(ResourceName("items", item));
  if (quantity.empty()) return available;
  MORTISE_ASSIGN_OR_RETURN(const double pieces, parametric::ParseCsvNumber(quantity));
  if (pieces < 0) return absl::InvalidArgumentError("must not be negative");
  available.set_quantity(pieces);
  return available;
}

}  // namespace

absl::StatusOr<std::vector<v1::AvailableItem>> ParseAvailableItems(std::string_view text,
                                                                   const std::string& origin) {
  parametric::CsvTable table = parametric::ParseCsv(text);
  std::vector<FieldViolation> findings = std::move(table.findings);
  std::vector<v1::AvailableItem> items;
  std::optional<std::size_t> item, quantity;
  if (!table.rows.empty()) {
    item = ColumnOf(table.rows.front(), "item");
    if (!item) item = ColumnOf(table.rows.front(), "name");
    quantity = ColumnOf(table.rows.front(), "quantity");
  }
  if (!item && findings.empty()) {
    findings.push_back({"line 1", "has no column 'item', nor 'name'"});
  }
  for (std::size_t i = 1; item && i < table.rows.size(); ++i) {
    const parametric::CsvRow& row = table.rows[i];
    absl::StatusOr<v1::AvailableItem> read =
        Available(row[*item].text, quantity ? row[*quantity].text : "");
    if (read.ok()) {
      items.push_back(*std::move(read));
    } else {
      findings.push_back(
          {parametric::PlaceOf(row[*quantity]), std::string(read.status().message())});
    }
  }
  for (FieldViolation& finding : findings) {
    finding.field = absl::StrCat(origin, ": ", finding.field);
  }
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  return items;
}

absl::StatusOr<std::vector<v1::AvailableItem>> ReadAvailableItems(
    const std::filesystem::path& path) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxBytes));
  return ParseAvailableItems(text, path.string());
}

absl::StatusOr<v1::AvailableItem> ParseAvailableItem(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return Available(text, "");
  const std::string name = text.substr(0, equals);
  const std::string quantity = text.substr(equals + 1);
  absl::StatusOr<v1::AvailableItem> item =
      quantity.empty() ? absl::InvalidArgumentError("how many is missing after the equals sign")
                       : Available(name, quantity);
  if (item.ok()) return item;
  return InvalidField(absl::StrCat("--item ", name), std::string(item.status().message()));
}

}  // namespace mortise::cli
