#include "cli/client/field_sources.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"

namespace mortise::cli {
namespace {

// Whether `path` is `field` or lies in it: "parameters[0].value" in "parameters".
bool LiesIn(std::string_view path, std::string_view field) {
  if (!path.starts_with(field)) return false;
  const std::string_view rest = path.substr(field.size());
  return rest.empty() || rest.front() == '.' || rest.front() == '[';
}

}  // namespace

void FieldSources::Add(std::string field, std::string source) {
  sources_.push_back({std::move(field), std::move(source)});
}

void FieldSources::AddEach(const std::string& field, const std::string& flag,
                           const std::vector<std::string>& values, int first) {
  if (first == 0) Add(field, flag);
  for (const std::string& value : values) {
    Add(absl::StrCat(field, "[", first++, "]"),
        absl::StrCat(flag, " ", value.substr(0, value.find('='))));
  }
}

void FieldSources::AddFile(std::string field, std::string file) {
  sources_.push_back({std::move(field), std::move(file), true});
}

std::string FieldSources::SourceOf(std::string_view field) const {
  const Source* best = nullptr;
  for (const Source& source : sources_) {
    if (!LiesIn(field, source.field)) continue;
    if (best == nullptr || source.field.size() > best->field.size()) best = &source;
  }
  if (best == nullptr) return std::string(field);
  if (!best->is_file || field.size() == best->field.size()) return best->text;
  const std::string_view rest = field.substr(best->field.size());
  return absl::StrCat(best->text, ": ", absl::StripPrefix(std::string(rest), "."));
}

absl::Status FieldSources::Name(const absl::Status& status) const {
  if (status.ok()) return status;
  std::vector<FieldViolation> violations = ViolationsOf(status);
  std::vector<FieldViolation> named;
  for (FieldViolation& violation : violations) {
    violation.field = SourceOf(violation.field);
    // One flag may give several fields: what is wrong with each of them is said of it once.
    const bool is_told = std::any_of(named.begin(), named.end(), [&](const FieldViolation& each) {
      return each.field == violation.field && each.message == violation.message;
    });
    if (!is_told) named.push_back(std::move(violation));
  }
  if (!named.empty()) return InvalidFields(named);
  ErrorDetail detail = DetailOf(status);
  const std::string field = detail.field;
  detail.field = SourceOf(field);
  if (detail.field == field) return status;
  // Failures begin with the field, and a colon or, of what is too large, a blank.
  absl::string_view message = status.message();
  const bool names_field = absl::ConsumePrefix(&message, field) &&
                           (absl::StartsWith(message, ": ") || absl::StartsWith(message, " "));
  return WithDetail(absl::Status(status.code(), names_field ? absl::StrCat(detail.field, message)
                                                            : std::string(status.message())),
                    detail);
}

}  // namespace mortise::cli
