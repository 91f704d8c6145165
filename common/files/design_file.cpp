#include "common/files/design_file.h"

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/files.h"
#include "common/base/text_encoding.h"
#include "common/files/collection.h"
#include "common/files/csv_designs.h"
#include "common/files/csv_table.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{4} << 20;
constexpr std::string_view kTemplateMark = "# proto-message: mortise.v1.Template";
constexpr std::string_view kCadTemplateMark = "# proto-message: mortise.v1.CadTemplate";
constexpr std::string_view kCageTemplateMark = "# proto-message: mortise.v1.CageTemplate";

// All that `status` says of the file `origin`; the caller says which file it is.
DesignFile Failed(const absl::Status& status, const std::string& origin) {
  std::vector<FieldViolation> violations = ViolationsOf(status);
  if (violations.empty()) {
    const std::string field = DetailOf(status).field;
    std::string message(status.message());
    if (message.starts_with(field + ": ")) message.erase(0, field.size() + 2);
    violations.push_back({field, std::move(message)});
  }
  DesignFile file;
  for (FieldViolation& violation : violations) {
    std::string& place = violation.field;
    if (place.starts_with(origin)) place.erase(0, origin.size());
    if (place.starts_with(": ")) place.erase(0, 2);
    file.findings.push_back({std::move(place), std::move(violation.message)});
  }
  return file;
}

// Whether a line is `wanted`, but for white space behind it.
bool HasLine(std::string_view text, std::string_view wanted) {
  for (std::size_t at = text.find(wanted); at != std::string_view::npos;
       at = text.find(wanted, at + 1)) {
    const std::size_t end = at + wanted.size();
    if (end == text.size() || absl::ascii_isspace(static_cast<unsigned char>(text[end]))) {
      return true;
    }
  }
  return false;
}

DesignFile ParseDesignText(std::string_view text, const std::string& origin) {
  DesignFile file;
  struct Kind {
    std::string_view mark;
    absl::StatusOr<v1::Template> (*parse)(std::string_view, const std::string&);
  };
  static constexpr Kind kKinds[] = {{kTemplateMark, ParseTemplateText},
                                    {kCadTemplateMark, ParseCadTemplateText},
                                    {kCageTemplateMark, ParseCageTemplateMessage}};
  for (const auto& [mark, parse] : kKinds) {
    if (!HasLine(text, mark)) continue;
    absl::StatusOr<v1::Template> message = parse(text, origin);
    if (!message.ok()) return Failed(message.status(), origin);
    file.templates.push_back({*std::move(message), "", {}, {}});
    return file;
  }
  absl::StatusOr<v1::TemplateBundle> bundle = ParseBundleText(text, origin);
  if (!bundle.ok()) return Failed(bundle.status(), origin);
  for (v1::Material& material : *bundle->mutable_materials()) {
    file.materials.push_back({std::move(material), "", {}, {}});
  }
  for (v1::Item& item : *bundle->mutable_items()) {
    file.items.push_back({std::move(item), "", {}, {}});
  }
  if (bundle->has_template_()) {
    file.templates.push_back({std::move(*bundle->mutable_template_()), "", {}, {}});
  }
  return file;
}

}  // namespace

DesignFile ParseDesignCsv(std::string_view text) {
  const std::string separator = OtherSeparator(text);
  if (!separator.empty() && EncodingFault(text).empty()) {
    DesignFile file;
    file.findings.push_back(
        {"line 1", absl::StrCat("separates cells by ", separator,
                                "; save the file with commas between them, and with points in "
                                "numbers, such as 2.95")});
    return file;
  }
  const CsvTable table = ParseCsv(text);
  std::vector<FieldViolation> findings = table.findings;
  if (table.rows.empty()) {
    DesignFile file;
    if (findings.empty()) {
      findings.push_back({"line 1", "is missing: the first row names the columns"});
    }
    file.findings = std::move(findings);
    return file;
  }
  const CsvRow& header = table.rows[0];
  const bool has_density = std::any_of(header.begin(), header.end(),
                                       [](const CsvCell& cell) { return cell.text == "density"; });
  DesignFile file = has_density ? MaterialsOfTable(table) : ItemsOfTable(table);
  findings.insert(findings.end(), file.findings.begin(), file.findings.end());
  if (table.rows.size() == 1 && findings.empty()) {
    findings.push_back({"line 1", "names the columns, but no row follows"});
  }
  file.findings = std::move(findings);
  file.unlisted += table.unlisted;
  return file;
}

std::string PlaceOf(const std::string& place, const std::map<std::string, std::string>& fields,
                    const std::string& field) {
  for (std::string path = field; !path.empty();) {
    const auto found = fields.find(path);
    if (found != fields.end()) return found->second;
    const std::size_t end = path.find_last_of(".[");
    path.resize(end == std::string::npos ? 0 : end);
  }
  return place;
}

DesignFile ReadDesignFile(const std::filesystem::path& path) {
  const absl::StatusOr<std::string> text = ReadFile(path, kMaxBytes);
  if (!text.ok()) return Failed(text.status(), path.string());
  const std::string extension = LowerCaseExtension(path);
  if (extension == ".csv") return ParseDesignCsv(*text);
  if (extension == ".json") return ParseDesignJson(*text);
  return ParseDesignText(*text, path.string());
}

std::optional<std::pair<std::size_t, std::string>> ElementOf(const std::string& field,
                                                             const std::string& list) {
  if (!field.starts_with(list + "[")) return std::nullopt;
  const std::size_t end = field.find(']');
  std::size_t index = 0;
  if (end == std::string::npos ||
      !absl::SimpleAtoi(field.substr(list.size() + 1, end - list.size() - 1), &index)) {
    return std::nullopt;
  }
  const std::string rest = field.substr(end + 1);
  return std::pair(index, rest.starts_with(".") ? rest.substr(1) : rest);
}

}  // namespace mortise::parametric
