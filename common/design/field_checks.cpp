#include "common/design/field_checks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/identifiers.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxText = 1000;              // bytes
constexpr std::ptrdiff_t kMaxTitle = 200;           // characters
constexpr std::ptrdiff_t kMaxDescription = 10'000;  // characters

constexpr std::size_t kMaxChoices = 1000;  // values of a choice
constexpr std::size_t kMaxChoice = 100;    // bytes of the name of one

constexpr const char* kUnits[] = {"1",   "m",     "m^2",   "m^3", "rad", "kg",       "kg/m^3", "s",
                                  "m/s", "m/s^2", "rad/s", "Hz",  "N",   "N m",      "N/m",    "Pa",
                                  "J",   "W",     "W/m^2", "K",   "1/K", "W/(m^2 K)"};

void CheckCharacters(const std::string& field, const std::string& text, std::ptrdiff_t most,
                     std::vector<FieldViolation>& findings) {
  // Each character of UTF-8 has one byte that continues no other.
  const auto characters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  });
  if (characters > most) {
    findings.push_back({field, absl::StrCat("is longer than ", most, " characters")});
  }
}

}  // namespace

void CheckResourceName(const std::string& name, const std::string& collection,
                       std::vector<FieldViolation>& findings) {
  if (!ParseResourceName(name, collection, "name").ok()) {
    findings.push_back({"name", absl::StrCat("must be '", collection,
                                             "/' and 1 to 63 lower-case letters, digits and "
                                             "hyphens")});
  }
}

void CheckTitle(const std::string& field, const std::string& text,
                std::vector<FieldViolation>& findings) {
  CheckCharacters(field, text, kMaxTitle, findings);
}

void CheckDescription(const std::string& field, const std::string& text,
                      std::vector<FieldViolation>& findings) {
  CheckCharacters(field, text, kMaxDescription, findings);
}

void CheckText(const std::string& field, const std::string& text,
               std::vector<FieldViolation>& findings) {
  if (text.size() > kMaxText) {
    findings.push_back({field, absl::StrCat("is longer than ", kMaxText, " bytes")});
  }
}

// People click on links: only what leads to a page is one.
void CheckLink(const std::string& field, const std::string& link,
               std::vector<FieldViolation>& findings) {
  CheckText(field, link, findings);
  if (link.empty() || link.starts_with("https://") || link.starts_with("http://")) return;
  findings.push_back({field, "must begin with https:// or http://"});
}

void CheckUnit(const std::string& field, const std::string& unit,
               std::vector<FieldViolation>& findings) {
  if (unit.empty()) {
    findings.push_back({field, "is missing; say '1' where there is none"});
  } else if (std::find(std::begin(kUnits), std::end(kUnits), unit) == std::end(kUnits)) {
    findings.push_back({field, absl::StrCat("must be one of ", absl::StrJoin(kUnits, ", "))});
  }
}

void CheckChoices(const std::string& field, const Parameter& parameter,
                  std::vector<FieldViolation>& findings) {
  const std::vector<std::string>& choices = parameter.choices;
  const auto report = [&](const std::string& part, const std::string& message) {
    findings.push_back({absl::StrCat(field, ".", part), message});
  };
  if (choices.size() < 2 || choices.size() > kMaxChoices) {
    return report("choices",
                  absl::StrCat("are ", choices.size(), "; 2 to ", kMaxChoices, " are accepted"));
  }
  std::set<std::string> seen;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const std::string place = absl::StrCat("choices[", i, "]");
    const bool is_plain = std::all_of(choices[i].begin(), choices[i].end(), [](char c) {
      return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f && c != ',' && c != '\'' &&
             c != '"';
    });
    if (choices[i].empty() || choices[i].size() > kMaxChoice || !is_plain ||
        choices[i].front() == ' ' || choices[i].back() == ' ') {
      report(place, absl::StrCat("must be 1 to ", kMaxChoice,
                                 " bytes without commas, quotes and control characters, and not "
                                 "begin or end with a blank"));
    } else if (!seen.insert(choices[i]).second) {
      report(place, absl::StrCat("'", choices[i], "' is there twice"));
    }
  }
  const auto last = static_cast<double>(choices.size()) - 1;
  const auto expect = [&](const char* number, double value, double expected) {
    if (value == expected) return;
    report(number, absl::StrCat("must be ", expected,
                                ", or left out: the values of a choice are numbered"));
  };
  expect("minimum", parameter.minimum, 0);
  expect("maximum", parameter.maximum, last);
  expect("step", parameter.step, 1);
  if (parameter.unit != "1") report("unit", "must be 1, or left out: a choice has no unit");
  const double chosen = parameter.default_value;
  if (!(chosen >= 0 && chosen <= last && chosen == std::round(chosen))) {
    report("default_value",
           absl::StrCat("must be the number of a value, 0 to ", last, ", not ", chosen));
  }
}

void CheckPositive(const std::string& field, double value, std::vector<FieldViolation>& findings) {
  if (!(value > 0) || !std::isfinite(value)) {
    findings.push_back({field, "must be a finite number greater than 0"});
  }
}

void CheckNotNegative(const std::string& field, double value,
                      std::vector<FieldViolation>& findings) {
  if (!(value >= 0) || !std::isfinite(value)) {
    findings.push_back({field, "must be a finite number, at least 0"});
  }
}

}  // namespace mortise::parametric
