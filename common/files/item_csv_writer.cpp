#include "common/files/item_csv_writer.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/text_escapes.h"

namespace mortise::parametric {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::string_view kLineEnd = "\r\n";
constexpr std::array<const char*, 3> kAxisColumns = {"length", "width", "thickness"};
// Columns that are always there, in their order; others follow by name.
constexpr std::array<const char*, 17> kUsualColumns = {
    "name",         "title",           "kind",     "material",    "length",          "width",
    "thickness",    "price",           "currency", "price_basis", "price_date",      "supplier",
    "supplier_url", "supplier_number", "standard", "designation", "price_is_example"};

// The cells of an item by the columns that it needs.
using ItemCells = std::map<std::string, std::string>;

// The shortest decimals that are read as this number.
std::string DecimalsOf(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return std::string(text.data(), end);
}

// A number of which 0 says that it is not stated.
void PutNumber(ItemCells& cells, const std::string& column, double value) {
  if (value != 0) cells[column] = DecimalsOf(value);
}

void PutText(ItemCells& cells, const std::string& column, std::string text) {
  if (!text.empty()) cells[column] = std::move(text);
}

// The name of an enum's value; empty for the first, which says nothing.
std::string EnumName(const v1::Item& item, const char* field_name) {
  const auto* field = v1::Item::descriptor()->FindFieldByName(field_name);
  const auto* value = item.GetReflection()->GetEnum(item, field);
  return value->number() == 0 ? std::string() : value->name();
}

// What a list in a cell has between its separators must be read as it was.
bool FitsIntoList(std::string_view text, std::string_view separators) {
  return text.find_first_of(separators) == std::string_view::npos &&
         absl::StripAsciiWhitespace({text.data(), text.size()}).size() == text.size();
}

absl::Status DoesNotFit(const v1::Item& item, std::string_view what) {
  return PreconditionFailed("NOT_IN_CSV",
                            absl::StrCat(item.name(), " has ", std::string(what),
                                         " that no cell can hold; read it as JSON"),
                            item.name());
}

void PutDimensions(const v1::Item& item, ItemCells& cells) {
  for (const v1::ItemDimension& dimension : item.dimensions()) {
    const int axis = dimension.axis() - v1::X;
    if (axis < 0 || axis >= static_cast<int>(kAxisColumns.size())) continue;
    const std::string column = kAxisColumns[static_cast<std::size_t>(axis)];
    PutNumber(cells, column, dimension.size());
    PutNumber(cells, column + ".minimum", dimension.minimum());
    PutNumber(cells, column + ".maximum", dimension.maximum());
    PutNumber(cells, column + ".nominal", dimension.nominal());
    PutText(cells, column + ".name", dimension.name());
    if (dimension.process() != v1::PROCESS_UNSPECIFIED) {
      cells[column + ".process"] = v1::Process_Name(dimension.process());
    }
  }
}

void PutMeasures(const v1::Item& item, ItemCells& cells) {
  for (const v1::ItemMeasure& measure : item.measures()) {
    const std::string column = "measure." + measure.name();
    PutNumber(cells, column, measure.size());
    PutNumber(cells, column + ".minimum", measure.minimum());
    PutNumber(cells, column + ".maximum", measure.maximum());
  }
}

void PutStockSizes(const v1::Item& item, ItemCells& cells) {
  std::vector<std::string> sizes;
  for (const v1::StockSize& stock : item.stock_sizes()) {
    std::string text = DecimalsOf(stock.length());
    if (stock.width() != 0) absl::StrAppend(&text, "x", DecimalsOf(stock.width()));
    if (stock.has_price()) absl::StrAppend(&text, "@", DecimalsOf(stock.price()));
    sizes.push_back(std::move(text));
  }
  PutText(cells, "stock_sizes", absl::StrJoin(sizes, "; "));
}

absl::Status PutLists(const v1::Item& item, ItemCells& cells) {
  std::vector<std::string> suppliers;
  for (const v1::SupplierLink& link : item.more_suppliers()) {
    for (const std::string& part : {link.supplier(), link.url(), link.number()}) {
      if (!FitsIntoList(part, ";|")) return DoesNotFit(item, "a supplier");
    }
    suppliers.push_back(absl::StrCat(link.supplier(), " | ", link.url(), " | ", link.number()));
  }
  PutText(cells, "more_suppliers", absl::StrJoin(suppliers, "; "));
  for (const std::string& id : item.external_ids()) {
    if (!FitsIntoList(id, ";")) return DoesNotFit(item, "an external id");
  }
  PutText(cells, "external_ids", absl::StrJoin(item.external_ids(), "; "));
  const std::map<std::string, std::string> labels(item.labels().begin(), item.labels().end());
  for (const auto& [key, value] : labels) {
    if (!FitsIntoList(key, ";=") || !FitsIntoList(value, ";")) return DoesNotFit(item, "a label");
  }
  PutText(cells, "labels", absl::StrJoin(labels, "; ", absl::PairFormatter("=")));
  return absl::OkStatus();
}

absl::StatusOr<ItemCells> CellsOf(const v1::Item& item) {
  ItemCells cells;
  PutText(cells, "name", item.name());
  PutText(cells, "title", item.title());
  PutText(cells, "material", item.material());
  PutText(cells, "price_date", item.price_date());
  PutText(cells, "supplier", item.supplier());
  PutText(cells, "supplier_url", item.supplier_url());
  PutText(cells, "supplier_number", item.supplier_number());
  PutText(cells, "standard", item.standard());
  PutText(cells, "designation", item.designation());
  PutText(cells, "shape", item.shape());
  for (const char* column : {"kind", "price_basis", "grain_axis", "radial_axis"}) {
    PutText(cells, column, EnumName(item, column));
  }
  cells["price"] = DecimalsOf(item.price().amount());
  PutText(cells, "currency", item.price().currency());
  if (item.price_is_example()) cells["price_is_example"] = "true";
  PutDimensions(item, cells);
  PutMeasures(item, cells);
  PutStockSizes(item, cells);
  MORTISE_RETURN_IF_ERROR(PutLists(item, cells));
  return cells;
}

std::vector<std::string> ColumnsOf(const std::vector<ItemCells>& rows) {
  std::vector<std::string> columns(kUsualColumns.begin(), kUsualColumns.end());
  const std::set<std::string> usual(columns.begin(), columns.end());
  std::set<std::string> more;
  for (const ItemCells& row : rows) {
    for (const auto& [column, text] : row) {
      if (usual.count(column) == 0) more.insert(column);
    }
  }
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

}  // namespace

absl::StatusOr<std::string> ItemsAsCsv(const std::vector<v1::Item>& items) {
  std::vector<ItemCells> rows;
  for (const v1::Item& item : items) {
    MORTISE_ASSIGN_OR_RETURN(ItemCells cells, CellsOf(item));
    rows.push_back(std::move(cells));
  }
  const std::vector<std::string> columns = ColumnsOf(rows);
  std::string table(kByteOrderMark);
  absl::StrAppend(&table, absl::StrJoin(columns, ","),
                  absl::string_view(kLineEnd.data(), kLineEnd.size()));
  for (const ItemCells& row : rows) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) table.push_back(',');
      const auto cell = row.find(columns[i]);
      if (cell != row.end()) table += CsvField(SpreadsheetText(cell->second));
    }
    table.append(kLineEnd);
  }
  return table;
}

}  // namespace mortise::parametric
