#include "common/design/parameter_values.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/errors.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {
namespace {

using Eigen::VectorXd;

constexpr double kRangeTolerance = 1e-9;          // of a parameter's range
constexpr Eigen::Index kMaxCornerParameters = 6;  // 2⁶ corners

// What is wrong with a value of a parameter; nothing if it is usable.
std::optional<std::string> FaultOf(const Parameter& parameter, double value) {
  if (!std::isfinite(value)) return "is not a finite number";
  const double slack = kRangeTolerance * (parameter.maximum - parameter.minimum);
  if (value >= parameter.minimum - slack && value <= parameter.maximum + slack) return {};
  const std::vector<std::string> texts =
      ComparedNumbers({value, parameter.minimum, parameter.maximum});
  return absl::StrCat("'", parameter.name, "' is ", texts[0], ", outside its range ", texts[1],
                      " to ", texts[2], " ", parameter.unit);
}

}  // namespace

VectorXd Defaults(const std::vector<Parameter>& parameters) {
  VectorXd q(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    q(i) = parameters[static_cast<std::size_t>(i)].default_value;
  }
  return q;
}

absl::StatusOr<VectorXd> CompleteParameters(const std::vector<Parameter>& parameters,
                                            const std::vector<NamedValue>& values) {
  VectorXd q = Defaults(parameters);
  std::set<std::string> seen;
  std::vector<FieldViolation> faults;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const NamedValue& given = values[i];
    const std::string field = absl::StrCat("parameters[", i, "]");
    const auto found =
        std::find_if(parameters.begin(), parameters.end(),
                     [&](const Parameter& entry) { return entry.name == given.name; });
    if (found == parameters.end()) {
      faults.push_back({field + ".name", absl::StrCat("there is no parameter '", given.name, "'")});
    } else if (!seen.insert(given.name).second) {
      faults.push_back({field + ".name", absl::StrCat("'", given.name, "' is given twice")});
    } else if (const auto fault = FaultOf(*found, given.value)) {
      faults.push_back({field + ".value", *fault});
    } else {
      q(found - parameters.begin()) = given.value;
    }
  }
  MORTISE_RETURN_IF_ERROR(ToStatus(faults));
  return q;
}

VectorXd RoundToSteps(const std::vector<Parameter>& parameters, const VectorXd& q) {
  VectorXd rounded = q;
  const auto count = std::min<Eigen::Index>(q.size(), static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& parameter = parameters[static_cast<std::size_t>(i)];
    if (parameter.step > 0) rounded(i) = std::round(q(i) / parameter.step) * parameter.step;
    rounded(i) = std::clamp(rounded(i), parameter.minimum, parameter.maximum);
  }
  return rounded;
}

absl::Status CheckParameterValues(const std::vector<Parameter>& parameters, const VectorXd& q) {
  if (q.size() != static_cast<Eigen::Index>(parameters.size())) {
    return InvalidField("parameters",
                        absl::StrCat("has ", q.size(), " values, not ", parameters.size()));
  }
  std::vector<FieldViolation> faults;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto fault = FaultOf(parameters[i], q(static_cast<Eigen::Index>(i)));
    if (fault) faults.push_back({absl::StrCat("parameters[", i, "].value"), *fault});
  }
  return ToStatus(faults);
}

std::vector<FieldViolation> CheckRanges(const std::vector<Parameter>& parameters,
                                        const Eigen::Ref<const VectorXd>& q) {
  if (q.size() != static_cast<Eigen::Index>(parameters.size())) {
    return {{"parameters", absl::StrCat("are ", q.size(), ", not ", parameters.size())}};
  }
  std::vector<FieldViolation> findings;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double value = q(static_cast<Eigen::Index>(i));
    if (value >= parameters[i].minimum && value <= parameters[i].maximum) continue;
    const std::vector<std::string> texts =
        ComparedNumbers({value, parameters[i].minimum, parameters[i].maximum});
    findings.push_back({absl::StrCat("parameters[", i, "]"),
                        absl::StrCat("'", parameters[i].name, "' is ", texts[0], ", outside of ",
                                     texts[1], " to ", texts[2])});
  }
  return findings;
}

std::vector<VectorXd> TrialPoints(const std::vector<Parameter>& parameters, int random) {
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
  std::mt19937_64 bits(1);
  for (int k = 0; k < random; ++k) {
    VectorXd q(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double unit = static_cast<double>(bits() >> 11) * 0x1p-53;
      q(i) = low(i) + unit * (high(i) - low(i));
    }
    points.push_back(q);
  }
  return points;
}

std::string ToText(const std::vector<Parameter>& parameters, const Eigen::Ref<const VectorXd>& q) {
  std::string text;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    absl::StrAppend(&text, i == 0 ? "" : ", ", parameters[i].name, " = ",
                    q(static_cast<Eigen::Index>(i)));
  }
  return text;
}

std::vector<NamedValue> NamedValues(const std::vector<Parameter>& parameters, const VectorXd& q) {
  std::vector<NamedValue> values;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    values.push_back({parameters[i].name, q(static_cast<Eigen::Index>(i))});
  }
  return values;
}

}  // namespace mortise::parametric
