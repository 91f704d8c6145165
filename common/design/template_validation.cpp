// Validates templates: first as written, then at many points of the parameter box.
#include "common/design/template_validation.h"

#include <cmath>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/design/compiled_template.h"
#include "common/design/design_checks.h"
#include "common/design/parameter_values.h"
#include "common/design/template_checks.h"

namespace mortise::parametric {
namespace {

using Eigen::VectorXd;

constexpr std::size_t kMaxFindings = 100;
constexpr int kRandomPoints = 64;

// A message with its numbers left out: what makes two findings the same kind.
std::string WithoutNumbers(const std::string& message) {
  std::string kind;
  for (const char c : message) {
    if ((c < '0' || c > '9') && c != '.' && c != '-' && c != 'e' && c != '+') kind += c;
  }
  return kind;
}

}  // namespace

std::vector<FieldViolation> ValidateTemplate(const TemplateBundle& bundle) {
  std::vector<FieldViolation> findings = CheckTemplate(bundle);
  if (!findings.empty()) {
    if (findings.size() > kMaxFindings) findings.resize(kMaxFindings);
    return findings;
  }
  const auto compiled = CompileTemplate(bundle);
  if (!compiled.ok()) {
    return {{DetailOf(compiled.status()).field, std::string(compiled.status().message())}};
  }
  const std::vector<Parameter>& parameters = bundle.definition.parameters;
  std::set<std::string> known;
  bool at_defaults = true;
  for (const VectorXd& q : TrialPoints(parameters, kRandomPoints)) {
    const std::string where =
        at_defaults ? "at the defaults" : absl::StrCat("at ", ToText(parameters, q));
    for (FieldViolation& finding : CheckDesign(*compiled, q)) {
      if (!known.insert(absl::StrCat(finding.field, "|", WithoutNumbers(finding.message))).second) {
        continue;
      }
      finding.message = absl::StrCat(finding.message, " (", where, ")");
      findings.push_back(std::move(finding));
      if (findings.size() == kMaxFindings) return findings;
    }
    at_defaults = false;
  }
  return findings;
}

absl::Status ToStatus(const std::vector<FieldViolation>& findings) {
  if (findings.empty()) return absl::OkStatus();
  std::vector<FieldViolation> violations;
  for (const FieldViolation& finding : findings) {
    violations.push_back({finding.field, finding.message});
  }
  return InvalidFields(violations);
}

}  // namespace mortise::parametric
