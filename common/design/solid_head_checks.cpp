#include "common/design/solid_head_checks.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/identifiers.h"
#include "common/design/field_checks.h"
#include "common/expressions/identifier.h"

namespace mortise::parametric {
namespace {

void CheckRange(const std::string& field, const Parameter& parameter,
                std::vector<FieldViolation>& findings) {
  if (!std::isfinite(parameter.minimum) || !std::isfinite(parameter.maximum) ||
      !std::isfinite(parameter.default_value) || !std::isfinite(parameter.step)) {
    findings.push_back({field, "has a number that is not finite"});
  } else if (parameter.maximum <= parameter.minimum) {
    findings.push_back(
        {field + ".maximum", absl::StrCat("is ", parameter.maximum,
                                          ", not greater than the minimum ", parameter.minimum)});
  } else if (parameter.default_value < parameter.minimum ||
             parameter.default_value > parameter.maximum) {
    const std::vector<std::string> texts =
        ComparedNumbers({parameter.default_value, parameter.minimum, parameter.maximum});
    findings.push_back({field + ".default_value", absl::StrCat("is ", texts[0], ", outside of ",
                                                               texts[1], " to ", texts[2])});
  } else if (parameter.step < 0) {
    findings.push_back({field + ".step", "is less than 0"});
  }
}

}  // namespace

void CheckSolidTexts(const std::string& name, const std::string& title,
                     const std::string& description, const std::string& material,
                     std::vector<FieldViolation>& findings) {
  CheckResourceName(name, "templates", findings);
  if (!ParseResourceName(material, "materials", "material").ok()) {
    findings.push_back(
        {"material", "must be 'materials/' and 1 to 63 lower-case letters, digits and hyphens"});
  }
  CheckTitle("title", title, findings);
  CheckDescription("description", description, findings);
}

void CheckUniqueName(const std::string& field, const std::string& name, std::set<std::string>& seen,
                     std::vector<FieldViolation>& findings) {
  if (!IsIdentifier(name)) {
    findings.push_back(
        {field, "must be a letter or underscore, then letters, digits, underscores; 63 at most"});
  } else if (!seen.insert(name).second) {
    findings.push_back({field, absl::StrCat("'", name, "' occurs twice")});
  }
}

void CheckNumberName(const std::string& field, const std::string& name, std::set<std::string>& seen,
                     std::vector<FieldViolation>& findings) {
  CheckUniqueName(field, name, seen, findings);
  if (IsReserved(name)) {
    findings.push_back({field, absl::StrCat("'", name, "' is a word of the expression language")});
  }
}

void CheckSolidParameters(const std::vector<Parameter>& parameters, std::set<std::string>& seen,
                          std::vector<FieldViolation>& findings) {
  CheckCount("parameters", parameters.size(), 1, kMaxSolidParameters, findings);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string field = absl::StrCat("parameters[", i, "]");
    CheckNumberName(field + ".name", parameters[i].name, seen, findings);
    CheckTitle(field + ".title", parameters[i].title, findings);
    CheckDescription(field + ".description", parameters[i].description, findings);
    if (parameters[i].IsChoice()) {
      CheckChoices(field, parameters[i], findings);
      continue;
    }
    CheckUnit(field + ".unit", parameters[i].unit, findings);
    CheckRange(field, parameters[i], findings);
  }
}

void CheckCount(const std::string& field, std::size_t count, std::size_t least, std::size_t most,
                std::vector<FieldViolation>& findings) {
  if (count < least) findings.push_back({field, absl::StrCat("must be at least ", least)});
  if (count > most) findings.push_back({field, absl::StrCat("are more than ", most)});
}

}  // namespace mortise::parametric
