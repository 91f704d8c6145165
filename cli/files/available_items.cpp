#include "cli/files/available_items.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "cli/client/requests.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/files/csv_table.h"

namespace mortise::cli {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{4} << 20;

// A heading as it is compared.
std::string Heading(const parametric::CsvCell& cell) {
  return absl::AsciiStrToLower(absl::StripAsciiWhitespace(cell.text));
}

// The column of the header that is called so.
std::optional<std::size_t> ColumnOf(const parametric::CsvRow& header, std::string_view name) {
  const auto found =
      std::find_if(header.begin(), header.end(),
                   [name](const parametric::CsvCell& cell) { return Heading(cell) == name; });
  if (found == header.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header.begin());
}

// What a table's columns are.
struct Columns {
  std::optional<std::size_t> item, quantity;
  bool is_bill = false;  // of a plan, which ends with totals
};

// A header without quantities whose other columns may have them under another heading.
std::optional<FieldViolation> UnknownQuantity(const parametric::CsvRow& header) {
  if (ColumnOf(header, "kind")) return std::nullopt;  // a table of items
  for (const parametric::CsvCell& cell : header) {
    const std::string heading = Heading(cell);
    if (heading == "item" || heading == "name" || heading == "title") continue;
    return FieldViolation{
        parametric::PlaceOf(cell),
        absl::StrCat("'", cell.text,
                     "' is not known, and there is no column 'quantity': call it that if it has "
                     "the pieces, or leave it out for as many as it takes")};
  }
  return std::nullopt;
}

Columns ColumnsOf(const parametric::CsvTable& table, std::string_view text,
                  std::vector<FieldViolation>* findings) {
  Columns columns;
  const parametric::CsvRow header = table.rows.empty() ? parametric::CsvRow() : table.rows.front();
  columns.item = ColumnOf(header, "item");
  if (!columns.item) columns.item = ColumnOf(header, "name");
  columns.quantity = ColumnOf(header, "quantity");
  columns.is_bill = ColumnOf(header, "size_to_order").has_value();
  if (!columns.item && findings->empty()) {
    const std::string separator = parametric::OtherSeparator(text);
    findings->push_back(
        {"line 1", absl::StrCat("has no column 'item', nor 'name'",
                                separator.empty() ? "" : "; it separates cells by ", separator,
                                separator.empty() ? "" : ": save it with commas between them")});
  } else if (columns.item && !columns.quantity) {
    const auto unknown = UnknownQuantity(header);
    if (unknown) findings->push_back(*unknown);
  }
  return columns;
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

absl::StatusOr<std::vector<v1::AvailableItem>> ParseAvailableItems(
    std::string_view text, const std::string& origin, std::vector<std::string>* places) {
  parametric::CsvTable table = parametric::ParseCsv(text);
  std::vector<FieldViolation> findings = std::move(table.findings);
  const Columns columns = ColumnsOf(table, text, &findings);
  std::vector<v1::AvailableItem> items;
  std::vector<std::string> found_at;
  for (std::size_t i = 1; columns.item && i < table.rows.size(); ++i) {
    const parametric::CsvRow& row = table.rows[i];
    const std::string name(absl::StripAsciiWhitespace(row[*columns.item].text));
    const std::string quantity(
        absl::StripAsciiWhitespace(columns.quantity ? row[*columns.quantity].text : ""));
    if (columns.is_bill && name == "total" && quantity.empty()) continue;
    absl::StatusOr<v1::AvailableItem> read = Available(name, quantity);
    if (read.ok()) {
      AddAvailable({*std::move(read)},
                   {absl::StrCat(origin, ": ", parametric::PlaceOf(row[*columns.item]))}, &items,
                   &found_at);
    } else {
      findings.push_back(
          {parametric::PlaceOf(row[*columns.quantity]), std::string(read.status().message())});
    }
  }
  for (FieldViolation& finding : findings) {
    finding.field = absl::StrCat(origin, ": ", finding.field);
  }
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  if (places != nullptr) *places = std::move(found_at);
  return items;
}

absl::StatusOr<std::vector<v1::AvailableItem>> ReadAvailableItems(
    const std::filesystem::path& path, std::vector<std::string>* places) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxBytes));
  return ParseAvailableItems(text, path.string(), places);
}

void AddAvailable(std::vector<v1::AvailableItem> more, const std::vector<std::string>& more_places,
                  std::vector<v1::AvailableItem>* items, std::vector<std::string>* places) {
  for (std::size_t i = 0; i < more.size(); ++i) {
    const auto known =
        std::find_if(items->begin(), items->end(),
                     [&](const v1::AvailableItem& each) { return each.item() == more[i].item(); });
    if (known == items->end()) {
      items->push_back(std::move(more[i]));
      places->push_back(more_places[i]);
    } else if (known->has_quantity() && more[i].has_quantity()) {
      known->set_quantity(known->quantity() + more[i].quantity());
    } else {
      known->clear_quantity();
    }
  }
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
