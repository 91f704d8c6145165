// Materials as rows of comma-separated values.
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/base/text_escapes.h"
#include "common/files/csv_designs.h"
#include "common/files/csv_tags.h"

namespace mortise::parametric {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr std::size_t kMaxFindings = 100;
constexpr std::string_view kOrthotropicPrefix = "orthotropic.";
constexpr std::string_view kExternalIdsColumn = "external_ids";
constexpr std::string_view kLabelsColumn = "labels";
constexpr const char* kNeededColumns[] = {"name", "density", "youngs_modulus", "poissons_ratio",
                                          "strength"};

// What a column fills: a field of the material or of its orthotropic elasticity.
struct Column {
  std::string title;
  bool orthotropic = false;
  const FieldDescriptor* field = nullptr;  // null if there is no such column
};

Column ColumnOf(const std::string& title) {
  Column column;
  column.title = title;
  column.orthotropic = title.starts_with(kOrthotropicPrefix);
  column.field = column.orthotropic ? v1::OrthotropicElasticity::descriptor()->FindFieldByName(
                                          title.substr(kOrthotropicPrefix.size()))
                                    : v1::Material::descriptor()->FindFieldByName(title);
  if (column.field == nullptr) return column;
  const auto type = column.field->cpp_type();
  const bool is_plain = !column.field->is_repeated() && (type == FieldDescriptor::CPPTYPE_DOUBLE ||
                                                         type == FieldDescriptor::CPPTYPE_STRING ||
                                                         type == FieldDescriptor::CPPTYPE_BOOL);
  // Who created it, the service says.
  const bool is_cell =
      (is_plain && title != "creator") || title == kExternalIdsColumn || title == kLabelsColumn;
  if (!is_cell) column.field = nullptr;
  return column;
}

// What columns of materials may be called.
const std::vector<std::string>& Titles() {
  static const std::vector<std::string> kTitles = [] {
    std::vector<std::string> titles;
    const auto add = [&titles](const google::protobuf::Descriptor& type, std::string_view prefix) {
      for (int i = 0; i < type.field_count(); ++i) {
        std::string title = std::string(prefix) + type.field(i)->name();
        if (ColumnOf(title).field != nullptr) titles.push_back(std::move(title));
      }
    };
    add(*v1::Material::descriptor(), "");
    add(*v1::OrthotropicElasticity::descriptor(), kOrthotropicPrefix);
    return titles;
  }();
  return kTitles;
}

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
      columns_.push_back(ColumnOf(cell.text));
      if (columns_.back().field == nullptr) {
        Report(PlaceOf(cell),
               absl::StrCat("there is no column '", cell.text.substr(0, 80), "' of materials",
                            NearestOffered(cell.text.substr(0, 80), Titles())));
      } else if (!seen.insert(cell.text).second) {
        Report(PlaceOf(cell), absl::StrCat("'", cell.text, "' is there twice"));
        columns_.back().field = nullptr;
      }
    }
    for (const char* needed : kNeededColumns) {
      if (seen.count(needed) != 0) continue;
      Report(absl::StrCat("line ", row[0].line),
             absl::StrCat("the column '", needed, "' is missing"));
      missing_.insert(needed);
    }
  }

  void NoteName(const CsvRow& row) {
    for (std::size_t i = 0; i < std::min(row.size(), columns_.size()); ++i) {
      if (columns_[i].title == "name") file_.unread_names.insert(FromSpreadsheetText(row[i].text));
    }
  }

  void ReadRow(const CsvRow& row) {
    Placed<v1::Material> placed;
    placed.place = absl::StrCat("line ", row[0].line);
    placed.unread = missing_;
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (columns_[i].field == nullptr) continue;
      const std::string place = absl::StrCat(PlaceOf(row[i]), " (", columns_[i].title, ")");
      placed.fields[columns_[i].title] = place;
      const absl::Status filled =
          Fill(columns_[i], FromSpreadsheetText(row[i].text), placed.message);
      if (filled.ok()) continue;
      Report(place, std::string(filled.message()));
      placed.unread.insert(columns_[i].title);
    }
    file_.materials.push_back(std::move(placed));
  }

  // An empty cell says nothing: a material without any constant of an elasticity has none.
  static absl::Status Fill(const Column& column, const std::string& text, v1::Material& material) {
    if (text.empty()) return absl::OkStatus();
    if (column.title == kLabelsColumn) return ReadLabels(text, material.mutable_labels());
    if (column.title == kExternalIdsColumn) {
      ReadExternalIds(text, material.mutable_external_ids());
      return absl::OkStatus();
    }
    Message* message = &material;
    if (column.orthotropic) message = material.mutable_orthotropic();
    if (column.field->cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
      message->GetReflection()->SetString(message, column.field, text);
      return absl::OkStatus();
    }
    if (column.field->cpp_type() == FieldDescriptor::CPPTYPE_BOOL) {
      if (text != "true" && text != "false") {
        return absl::InvalidArgumentError("must be true or false");
      }
      message->GetReflection()->SetBool(message, column.field, text == "true");
      return absl::OkStatus();
    }
    const absl::StatusOr<double> value = ParseCsvNumber(text);
    message->GetReflection()->SetDouble(message, column.field, value.value_or(kUnreadNumber));
    return value.status();
  }

  std::vector<Column> columns_;  // without a field where the header is at fault
  UnreadFields missing_;         // of all rows, as the header has no column of them
  DesignFile file_;
};

}  // namespace

DesignFile MaterialsOfTable(const CsvTable& table) { return Reader().Run(table); }

}  // namespace mortise::parametric
