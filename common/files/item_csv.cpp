// Items as rows of comma-separated values.
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/base/text_escapes.h"
#include "common/design/field_checks.h"
#include "common/expressions/identifier.h"
#include "common/files/csv_designs.h"
#include "common/files/csv_table.h"
#include "common/files/csv_tags.h"
#include "common/files/design_file.h"

namespace mortise::parametric {
namespace {

using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;

constexpr std::string_view kMillimetreSuffix = "_mm";
constexpr std::string_view kMeasurePrefix = "measure.";
constexpr std::array<const char*, 3> kAxes = {"length", "width", "thickness"};
constexpr const char* kAxisFields[] = {"X", "Y", "Z"};
constexpr const char* kPlainColumns[] = {
    "name",         "title",       "kind",        "material",        "price_basis",
    "price_date",   "supplier",    "standard",    "grain_axis",      "price_is_example",
    "supplier_url", "designation", "radial_axis", "supplier_number", "shape"};

// Columns that there must be, and the fields that they fill.
struct NeededColumn {
  const char* name;
  const char* field;
};
constexpr NeededColumn kNeededColumns[] = {{"name", "name"},
                                           {"kind", "kind"},
                                           {"material", "material"},
                                           {"length", "dimensions[X].size"},
                                           {"width", "dimensions[Y].size"},
                                           {"thickness", "dimensions[Z].size"},
                                           {"price", "price.amount"},
                                           {"currency", "price.currency"},
                                           {"price_date", "price_date"}};
constexpr std::size_t kMaxFindings = 100;

// What a column fills.
struct Column {
  enum class Part {
    kPlain,
    kPrice,
    kCurrency,
    kDimension,
    kMeasure,
    kStockSizes,
    kMoreSuppliers,
    kExternalIds,
    kLabels,
    kUnknown  // the header is at fault
  };
  std::string title;    // as the header has it
  std::string meaning;  // without the unit: "length.minimum"
  Part part = Part::kPlain;
  std::size_t axis = 0;      // of a dimension
  std::string measure;       // name of a measure
  std::string detail;        // "size", "minimum" and so on of a dimension or measure
  bool millimetres = false;  // numbers are in mm, not m
};

bool IsOneOf(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// Splits "length.minimum" into the column's part and detail; false if there is no such column.
bool FindMeaning(Column& column) {
  const std::string& meaning = column.meaning;
  if (!column.millimetres) {
    for (const char* plain : kPlainColumns) {
      if (meaning == plain) return true;
    }
    static const std::map<std::string_view, Column::Part> kWithFormsOfTheirOwn = {
        {"price", Column::Part::kPrice},
        {"currency", Column::Part::kCurrency},
        {"more_suppliers", Column::Part::kMoreSuppliers},
        {"external_ids", Column::Part::kExternalIds},
        {"labels", Column::Part::kLabels}};
    if (const auto found = kWithFormsOfTheirOwn.find(meaning);
        found != kWithFormsOfTheirOwn.end()) {
      column.part = found->second;
      return true;
    }
  }
  if (meaning == "stock_sizes") {
    column.part = Column::Part::kStockSizes;
    return true;
  }
  const bool measures = meaning.starts_with(kMeasurePrefix);
  const std::string_view rest =
      std::string_view(meaning).substr(measures ? kMeasurePrefix.size() : 0);
  const std::size_t dot = rest.find('.');
  const std::string name(rest.substr(0, dot));
  column.detail = dot == std::string_view::npos ? "size" : std::string(rest.substr(dot + 1));
  if (dot != std::string_view::npos && column.detail == "size") return false;
  if (measures) {
    column.part = Column::Part::kMeasure;
    column.measure = name;
    return IsMeasureName(name) && IsOneOf(column.detail, {"size", "minimum", "maximum"});
  }
  column.part = Column::Part::kDimension;
  for (column.axis = 0; column.axis < kAxes.size(); ++column.axis) {
    if (name != kAxes[column.axis]) continue;
    if (IsOneOf(column.detail, {"size", "minimum", "maximum", "nominal"})) return true;
    return !column.millimetres && IsOneOf(column.detail, {"process", "name"});
  }
  return false;
}

absl::Status SetEnum(v1::Item& item, const FieldDescriptor* field, const std::string& text) {
  const EnumDescriptor& type = *field->enum_type();
  const auto* value = type.FindValueByName(text);
  if (value == nullptr || value->number() == 0) {
    std::string known;
    for (int i = 1; i < type.value_count(); ++i) {
      absl::StrAppend(&known, i == 1 ? "" : ", ", type.value(i)->name());
    }
    return absl::InvalidArgumentError(
        absl::StrCat("'", text.substr(0, 80), "' is none of ", known));
  }
  item.GetReflection()->SetEnum(&item, field, value);
  return absl::OkStatus();
}

// A field of the item that has the column's name.
absl::Status SetPlain(v1::Item& item, const std::string& name, const std::string& text) {
  const FieldDescriptor* field = v1::Item::descriptor()->FindFieldByName(name);
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_ENUM) return SetEnum(item, field, text);
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_BOOL) {
    if (text != "true" && text != "false") {
      return absl::InvalidArgumentError("must be true or false");
    }
    item.GetReflection()->SetBool(&item, field, text == "true");
    return absl::OkStatus();
  }
  item.GetReflection()->SetString(&item, field, text);
  return absl::OkStatus();
}

// "2.44x1.22@38; 3.05x1.525": lengths, widths of sheets, prices where they are known.
absl::Status SetStockSizes(v1::Item& item, const std::string& text, bool millimetres) {
  for (const absl::string_view part : absl::StrSplit(text, ';')) {
    std::string entry(absl::StripAsciiWhitespace(part));
    // Read on, this would be a length of 0 by a width.
    if (entry.starts_with("0x")) {
      return absl::InvalidArgumentError(absl::StrCat("'", entry.substr(0, 80),
                                                     "' is no size in decimal numbers, such as ",
                                                     millimetres ? "2440x1220" : "2.44x1.22"));
    }
    v1::StockSize& stock = *item.add_stock_sizes();
    if (const std::size_t at = entry.find('@'); at != std::string::npos) {
      MORTISE_ASSIGN_OR_RETURN(const double price, ParseCsvNumber(entry.substr(at + 1), false));
      stock.set_price(price);
      entry.resize(at);
    }
    if (const std::size_t times = entry.find('x'); times != std::string::npos) {
      MORTISE_ASSIGN_OR_RETURN(const double width,
                               ParseCsvNumber(entry.substr(times + 1), millimetres));
      stock.set_width(width);
      entry.resize(times);
    }
    MORTISE_ASSIGN_OR_RETURN(const double length, ParseCsvNumber(entry, millimetres));
    stock.set_length(length);
  }
  return absl::OkStatus();
}

// "Other Merchant | https://other.example/7 | 7; …": the link and the number may be left out.
absl::Status SetMoreSuppliers(v1::Item& item, const std::string& text) {
  for (const absl::string_view entry : absl::StrSplit(text, ';')) {
    std::vector<std::string> parts = absl::StrSplit(entry, '|');
    if (parts.size() > 3) {
      return absl::InvalidArgumentError("a supplier has a name, a link and a number, no more");
    }
    for (std::string& part : parts) part = std::string(absl::StripAsciiWhitespace(part));
    parts.resize(3);
    v1::SupplierLink& link = *item.add_more_suppliers();
    link.set_supplier(parts[0]);
    link.set_url(parts[1]);
    link.set_number(parts[2]);
  }
  return absl::OkStatus();
}

// Says that the header names a column which is none, and which may be meant.
std::string NoSuchColumn(const std::string& title) {
  static const std::vector<std::string> kTitles = [] {
    std::vector<std::string> titles(std::begin(kPlainColumns), std::end(kPlainColumns));
    for (const char* const other : {"price", "currency", "more_suppliers", "external_ids", "labels",
                                    "stock_sizes", "stock_sizes_mm"}) {
      titles.emplace_back(other);
    }
    for (const std::string axis : kAxes) {
      for (const char* const detail : {"", ".minimum", ".maximum", ".nominal"}) {
        titles.push_back(absl::StrCat(axis, detail));
        titles.push_back(absl::StrCat(axis, detail, "_mm"));
      }
      titles.push_back(absl::StrCat(axis, ".process"));
      titles.push_back(absl::StrCat(axis, ".name"));
    }
    return titles;
  }();
  const std::string shown = title.substr(0, 80);
  return absl::StrCat("there is no column '", shown, "'", NearestOffered(shown, kTitles));
}

// Makes items of rows.
class Reader {
 public:
  DesignFile Run(const CsvTable& table) {
    ReadHeader(table.rows[0]);
    for (std::size_t i = 1; i < table.rows.size(); ++i) ReadRow(table.rows[i]);
    for (const CsvRow& row : table.ragged) NoteName(row);
    return std::move(file_);
  }

 private:
  void Report(std::string place, std::string message) {
    if (file_.findings.size() < kMaxFindings) {
      file_.findings.push_back({std::move(place), std::move(message)});
    } else {
      ++file_.unlisted;
    }
  }

  void ReadHeader(const CsvRow& row) {
    std::set<std::string> seen;
    for (const CsvCell& cell : row) {
      Column column;
      column.title = cell.text;
      column.millimetres = cell.text.ends_with(kMillimetreSuffix);
      column.meaning = cell.text;
      if (column.millimetres) column.meaning.resize(cell.text.size() - kMillimetreSuffix.size());
      if (!FindMeaning(column)) {
        Report(PlaceOf(cell), NoSuchColumn(cell.text));
        column.part = Column::Part::kUnknown;
      } else if (!seen.insert(column.meaning).second) {
        Report(PlaceOf(cell), absl::StrCat("'", column.meaning, "' is there twice"));
        column.part = Column::Part::kUnknown;
      }
      columns_.push_back(std::move(column));
    }
    for (const NeededColumn& needed : kNeededColumns) {
      if (seen.count(needed.name) != 0) continue;
      Report(absl::StrCat("line ", row[0].line),
             absl::StrCat("the column '", needed.name, "' is missing"));
      missing_.insert(needed.field);
    }
  }

  void NoteName(const CsvRow& row) {
    for (std::size_t i = 0; i < std::min(row.size(), columns_.size()); ++i) {
      if (columns_[i].meaning == "name")
        file_.unread_names.insert(FromSpreadsheetText(row[i].text));
    }
  }

  void ReadRow(const CsvRow& row) {
    Placed<v1::Item> placed;
    placed.place = absl::StrCat("line ", row[0].line);
    v1::Item& item = placed.message;
    item.set_price_basis(v1::PER_PIECE);
    for (int axis = v1::X; axis <= v1::Z; ++axis) {
      item.add_dimensions()->set_axis(static_cast<v1::Axis>(axis));
    }
    placed.unread = missing_;
    for (const std::string& field : missing_) SetUnread(field, item);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const Filled filled = Fill(columns_[i], FromSpreadsheetText(row[i].text), item);
      if (filled.field.empty()) continue;
      const std::string place = absl::StrCat(PlaceOf(row[i]), " (", columns_[i].title, ")");
      placed.fields[filled.field] = place;
      if (filled.status.ok()) continue;
      Report(place, std::string(filled.status.message()));
      placed.unread.insert(filled.field);
    }
    file_.items.push_back(std::move(placed));
  }

  // A number that no column gives.
  static void SetUnread(const std::string& field, v1::Item& item) {
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      if (field != absl::StrCat("dimensions[", kAxisFields[axis], "].size")) continue;
      item.mutable_dimensions(static_cast<int>(axis))->set_size(kUnreadNumber);
    }
  }

  // The path of the field that a cell fills, empty for none, and whether the cell could be read.
  struct Filled {
    std::string field;
    absl::Status status;
  };

  // Puts a cell into the item.
  Filled Fill(const Column& column, const std::string& text, v1::Item& item) {
    switch (column.part) {
      case Column::Part::kUnknown:
        return {};
      case Column::Part::kPlain:
        return {column.meaning,
                text.empty() ? absl::OkStatus() : SetPlain(item, column.meaning, text)};
      case Column::Part::kCurrency:
        item.mutable_price()->set_currency(text);
        return {"price.currency", absl::OkStatus()};
      case Column::Part::kPrice: {
        const absl::StatusOr<double> amount = ParseCsvNumber(text, false);
        item.mutable_price()->set_amount(amount.value_or(kUnreadNumber));
        return {"price.amount", amount.status()};
      }
      case Column::Part::kStockSizes:
        return {"stock_sizes",
                text.empty() ? absl::OkStatus() : SetStockSizes(item, text, column.millimetres)};
      case Column::Part::kMoreSuppliers:
        return {"more_suppliers", text.empty() ? absl::OkStatus() : SetMoreSuppliers(item, text)};
      case Column::Part::kExternalIds:
        if (!text.empty()) ReadExternalIds(text, item.mutable_external_ids());
        return {"external_ids", absl::OkStatus()};
      case Column::Part::kLabels:
        return {"labels",
                text.empty() ? absl::OkStatus() : ReadLabels(text, item.mutable_labels())};
      case Column::Part::kDimension:
        return FillDimension(column, text, item);
      case Column::Part::kMeasure:
        break;
    }
    return FillMeasure(column, text, item);
  }

  Filled FillDimension(const Column& column, const std::string& text, v1::Item& item) {
    v1::ItemDimension& dimension = *item.mutable_dimensions(static_cast<int>(column.axis));
    const std::string field =
        absl::StrCat("dimensions[", kAxisFields[column.axis], "].", column.detail);
    if (text.empty()) return {field, absl::OkStatus()};
    if (column.detail == "name") {
      dimension.set_name(text);
      return {field, absl::OkStatus()};
    }
    if (column.detail == "process") {
      v1::Process process = v1::PROCESS_UNSPECIFIED;
      if (!v1::Process_Parse(text, &process)) {
        return {field, absl::InvalidArgumentError(absl::StrCat(
                           "'", text.substr(0, 80), "' is no process, such as CHOP_SAW"))};
      }
      dimension.set_process(process);
      return {field, absl::OkStatus()};
    }
    const absl::StatusOr<double> read = ParseCsvNumber(text, column.millimetres);
    const double value = read.value_or(kUnreadNumber);
    if (column.detail == "size") dimension.set_size(value);
    if (column.detail == "minimum") dimension.set_minimum(value);
    if (column.detail == "maximum") dimension.set_maximum(value);
    if (column.detail == "nominal") dimension.set_nominal(value);
    return {field, read.status()};
  }

  // Nothing for a measure that the item does not have.
  Filled FillMeasure(const Column& column, const std::string& text, v1::Item& item) {
    if (text.empty()) return {};
    const absl::StatusOr<double> read = ParseCsvNumber(text, column.millimetres);
    const double value = read.value_or(kUnreadNumber);
    int index = 0;
    while (index < item.measures_size() && item.measures(index).name() != column.measure) ++index;
    if (index == item.measures_size()) item.add_measures()->set_name(column.measure);
    v1::ItemMeasure& measure = *item.mutable_measures(index);
    if (column.detail == "size") measure.set_size(value);
    if (column.detail == "minimum") measure.set_minimum(value);
    if (column.detail == "maximum") measure.set_maximum(value);
    return {absl::StrCat("measures[", index, "].", column.detail), read.status()};
  }

  std::vector<Column> columns_;
  UnreadFields missing_;  // of all rows, as the header has no column of them
  DesignFile file_;
};

}  // namespace

DesignFile ItemsOfTable(const CsvTable& table) { return Reader().Run(table); }

}  // namespace mortise::parametric
