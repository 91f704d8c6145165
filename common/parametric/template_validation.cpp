// Validates templates: first as written, then at many points of the parameter box.
#include "common/parametric/template_validation.h"

#include <cmath>
#include <random>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/parametric/compiled_template.h"
#include "common/parametric/design_checks.h"
#include "common/parametric/template_checks.h"

namespace mortise::parametric {
namespace {

using Eigen::VectorXd;

constexpr std::size_t kMaxFindings = 100;
constexpr Eigen::Index kMaxCornerParameters = 6;  // 2⁶ corners
constexpr int kRandomPoints = 64;

// The points at which shapes are tried: the defaults first, so that what is wrong there is reported
// there.
std::vector<VectorXd> TrialPoints(const std::vector<Parameter>& parameters) {
  const auto count = static_cast<Eigen::Index>(parameters.size());
  VectorXd low(count), high(count), middle(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& parameter = parameters[static_cast<std::size_t>(i)];
    low(i) = parameter.minimum;
    high(i) = parameter.maximum;
    middle(i) = parameter.default_value;
  }
  std::vector<VectorXd> points = {middle};
  if (count <= kMaxCornerParameters) {
    for (int corner = 0; corner < (1 << count); ++corner) {
      VectorXd q(count);
      for (Eigen::Index i = 0; i < count; ++i) q(i) = (corner >> i) & 1 ? high(i) : low(i);
      points.push_back(q);
    }
  } else {
    for (Eigen::Index i = 0; i < count; ++i) {
      for (const double end : {low(i), high(i)}) {
        points.push_back(middle);
        points.back()(i) = end;
      }
    }
  }
  // The engine is exactly specified by the standard; its distributions are not.
  std::mt19937_64 random(1);
  for (int k = 0; k < kRandomPoints; ++k) {
    VectorXd q(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double unit = static_cast<double>(random() >> 11) * 0x1p-53;
      q(i) = low(i) + unit * (high(i) - low(i));
    }
    points.push_back(q);
  }
  return points;
}

std::string Describe(const std::vector<Parameter>& parameters, const VectorXd& q) {
  std::vector<std::string> values;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    values.push_back(absl::StrCat(parameters[i].name, " = ", q(static_cast<Eigen::Index>(i))));
  }
  return absl::StrJoin(values, ", ");
}

// A message with its numbers left out: what makes two findings the same kind.
std::string WithoutNumbers(const std::string& message) {
  std::string kind;
  for (const char c : message) {
    if ((c < '0' || c > '9') && c != '.' && c != '-' && c != 'e' && c != '+') kind += c;
  }
  return kind;
}

}  // namespace

std::vector<Finding> ValidateTemplate(const TemplateBundle& bundle) {
  std::vector<Finding> findings = CheckTemplate(bundle);
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
  for (const VectorXd& q : TrialPoints(parameters)) {
    const std::string where =
        at_defaults ? "at the defaults" : absl::StrCat("at ", Describe(parameters, q));
    for (Finding& finding : CheckDesign(*compiled, q)) {
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

absl::Status ToStatus(const std::vector<Finding>& findings) {
  if (findings.empty()) return absl::OkStatus();
  std::vector<FieldViolation> violations;
  for (const Finding& finding : findings) violations.push_back({finding.field, finding.message});
  return InvalidFields(violations);
}

}  // namespace mortise::parametric
