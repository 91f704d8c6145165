#include "cli/files/map_points.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/client/requests.h"
#include "cli/files/assignment.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/files/csv_table.h"

namespace mortise::cli {
namespace {

constexpr double kSameValue = 1e-9;  // relative: texts have fewer digits than numbers
constexpr std::size_t kMostFaults = 20;

std::string Trimmed(absl::string_view text) {
  return std::string(absl::StripAsciiWhitespace(text));
}

std::string NamesOf(const v1::DesignMap& map) {
  return absl::StrJoin(map.parameters(), ", ",
                       [](std::string* out, const auto& each) { out->append(each.name()); });
}

absl::StatusOr<double> ValueOf(const v1::MapParameter& parameter, const std::string& text,
                               const std::string& source) {
  const auto choice = std::ranges::find(parameter.choices(), text);
  if (choice != parameter.choices().end()) {
    return static_cast<double>(choice - parameter.choices().begin());
  }
  absl::StatusOr<double> number = ParseQuantity(text, source);
  if (number.ok() || parameter.choices().empty()) return number;
  return InvalidField(
      source, absl::StrCat("'", text, "' is none of ", absl::StrJoin(parameter.choices(), ", ")));
}

// A design that is being read.
class Point {
 public:
  Point(const v1::DesignMap& map, std::string source)
      : map_(map),
        source_(std::move(source)),
        values_(static_cast<std::size_t>(map.parameters_size())) {}

  absl::Status Set(const std::string& name, const std::string& text, const std::string& source) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const v1::MapParameter& parameter = map_.parameters(static_cast<int>(i));
      if (parameter.name() != name) continue;
      if (values_[i]) return InvalidField(source, absl::StrCat("'", name, "' is there twice"));
      MORTISE_ASSIGN_OR_RETURN(values_[i], ValueOf(parameter, text, source));
      return absl::OkStatus();
    }
    for (const v1::ParameterValue& fixed : map_.fixed()) {
      if (fixed.name() == name) return CheckFixed(fixed, text, source);
    }
    return InvalidField(
        source, absl::StrCat(map_.name(), " has no parameter '", name, "', but ", NamesOf(map_)));
  }

  absl::StatusOr<std::vector<double>> Finish() const {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const v1::MapParameter& parameter = map_.parameters(static_cast<int>(i));
      if (!values_[i]) {
        return InvalidField(source_,
                            absl::StrCat("lacks ", parameter.name(), ": ", RangeText(parameter)));
      }
      numbers.push_back(*values_[i]);
    }
    return numbers;
  }

 private:
  absl::Status CheckFixed(const v1::ParameterValue& fixed, const std::string& text,
                          const std::string& source) const {
    MORTISE_ASSIGN_OR_RETURN(const double value, ParseQuantity(text, source));
    if (std::abs(value - fixed.value()) <= kSameValue * std::abs(fixed.value())) {
      return absl::OkStatus();
    }
    return InvalidField(source, absl::StrFormat("%s is fixed at %.6g in %s", fixed.name(),
                                                fixed.value(), map_.name()));
  }

  const v1::DesignMap& map_;
  std::string source_;
  std::vector<std::optional<double>> values_;
};

// Returns whether a column has a metric of the map or its error, as pages of maps save them.
bool IsOfMetric(const v1::DesignMap& map, const std::string& column) {
  return std::ranges::any_of(map.metrics(), [&](const v1::MapMetric& metric) {
    return column == absl::StrCat(metric.name(), " [", metric.unit(), "]") ||
           column == absl::StrCat(metric.name(), " error [", metric.unit(), "]");
  });
}

absl::StatusOr<std::vector<double>> RowOf(const v1::DesignMap& map, const parametric::CsvRow& names,
                                          const std::vector<bool>& is_passed_over,
                                          const parametric::CsvRow& row,
                                          const std::string& origin) {
  const auto place = [&](const parametric::CsvCell& cell) {
    return absl::StrCat(origin, ": ", parametric::PlaceOf(cell));
  };
  Point point(map, place(row.front()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (is_passed_over[i]) continue;
    MORTISE_RETURN_IF_ERROR(point.Set(Trimmed(names[i].text), Trimmed(row[i].text), place(row[i])));
  }
  return point.Finish();
}

}  // namespace

std::string ParameterText(const v1::MapParameter& parameter, double value) {
  if (value >= 0 && value < parameter.choices_size()) {
    return parameter.choices(static_cast<int>(value));
  }
  return absl::StrFormat("%.6g", value);
}

std::string RangeText(const v1::MapParameter& parameter) {
  if (!parameter.choices().empty()) return absl::StrJoin(parameter.choices(), ", ");
  return absl::StrFormat("%.6g to %.6g %s", parameter.minimum(), parameter.maximum(),
                         parameter.unit());
}

absl::StatusOr<v1::ParameterValue> ParseMapValue(const v1::DesignMap& map, const std::string& text,
                                                 const std::string& source) {
  MORTISE_ASSIGN_OR_RETURN(const auto assigned, SplitAssignment(text, source));
  const auto parameter =
      std::ranges::find(map.parameters(), assigned.first, &v1::MapParameter::name);
  if (parameter == map.parameters().end()) {
    return InvalidField(source, absl::StrCat(map.name(), " does not vary '", assigned.first,
                                             "', but ", NamesOf(map)));
  }
  v1::ParameterValue value;
  value.set_name(assigned.first);
  MORTISE_ASSIGN_OR_RETURN(const double number, ValueOf(*parameter, assigned.second, source));
  value.set_value(number);
  return value;
}

absl::StatusOr<std::vector<double>> ParseMapPoint(const v1::DesignMap& map, const std::string& text,
                                                  const std::string& source) {
  Point point(map, source);
  for (const absl::string_view assignment : absl::StrSplit(text, ',')) {
    const std::vector<std::string> halves = absl::StrSplit(assignment, absl::MaxSplits('=', 1));
    if (halves.size() != 2 || Trimmed(halves[0]).empty()) {
      return InvalidField(source, absl::StrCat("'", text, "' is not of the form NAME=VALUE,…"));
    }
    MORTISE_RETURN_IF_ERROR(point.Set(Trimmed(halves[0]), Trimmed(halves[1]), source));
  }
  return point.Finish();
}

absl::StatusOr<std::vector<double>> ParseMapPoints(const v1::DesignMap& map, std::string_view table,
                                                   const std::string& origin) {
  const parametric::CsvTable csv = parametric::ParseCsv(table);
  std::vector<FieldViolation> faults;
  for (const FieldViolation& finding : csv.findings) {
    faults.push_back({absl::StrCat(origin, ": ", finding.field), finding.message});
  }
  std::vector<double> numbers;
  std::vector<bool> is_passed_over;
  if (!csv.rows.empty()) {
    for (const parametric::CsvCell& name : csv.rows[0]) {
      is_passed_over.push_back(IsOfMetric(map, Trimmed(name.text)));
    }
  }
  for (std::size_t i = 1; i < csv.rows.size() && faults.size() < kMostFaults; ++i) {
    absl::StatusOr<std::vector<double>> point =
        RowOf(map, csv.rows[0], is_passed_over, csv.rows[i], origin);
    if (!point.ok()) {
      const std::vector<FieldViolation> found = AllViolationsOf(point.status());
      faults.insert(faults.end(), found.begin(), found.end());
      continue;
    }
    numbers.insert(numbers.end(), point->begin(), point->end());
  }
  if (!faults.empty()) return InvalidFields(faults);
  if (!numbers.empty()) return numbers;
  return InvalidField(origin, absl::StrCat("has no designs: rows under the names ", NamesOf(map)));
}

}  // namespace mortise::cli
