#include "common/design/parameter_values.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/compared_numbers.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {
namespace {

using Eigen::VectorXd;

constexpr double kRangeTolerance = 1e-9;         // of a parameter's range
constexpr std::size_t kMaxCornerParameters = 6;  // 2⁶ corners
constexpr std::size_t kMaxCombinations = 256;    // of choices that are all tried

std::string ValuesOf(const Parameter& choice) {
  return absl::StrCat("'", absl::StrJoin(choice.choices, "', '"), "'");
}

// What is wrong with a value of a parameter; nothing if it is usable.
std::optional<std::string> FaultOf(const Parameter& parameter, double value) {
  if (!std::isfinite(value)) return "is not a finite number";
  if (parameter.IsChoice()) {
    const auto count = static_cast<double>(parameter.choices.size());
    if (value >= 0 && value < count && value == std::round(value)) return {};
    return absl::StrCat("'", parameter.name, "' is ", value, ", not the number of one of its ",
                        count, " values, ", ValuesOf(parameter));
  }
  const double slack = kRangeTolerance * (parameter.maximum - parameter.minimum);
  if (value >= parameter.minimum - slack && value <= parameter.maximum + slack) return {};
  const std::vector<std::string> texts =
      ComparedNumbers({value, parameter.minimum, parameter.maximum});
  return absl::StrCat("'", parameter.name, "' is ", texts[0], ", outside its range ", texts[1],
                      " to ", texts[2], " ", parameter.unit);
}

// The value that is meant, or what is wrong with what is given.
struct GivenValue {
  double value = 0;
  std::optional<std::string> fault = {};
};

GivenValue ReadValue(const Parameter& parameter, const NamedValue& given) {
  if (given.choice.empty()) return {given.value, FaultOf(parameter, given.value)};
  if (!parameter.IsChoice()) {
    return {0, absl::StrCat("'", parameter.name, "' is a number, no choice, so it cannot be '",
                            given.choice, "'")};
  }
  const auto found = std::find(parameter.choices.begin(), parameter.choices.end(), given.choice);
  if (found == parameter.choices.end()) {
    return {0, absl::StrCat("'", parameter.name, "' has no value '", given.choice, "'; it has ",
                            ValuesOf(parameter))};
  }
  const auto number = static_cast<double>(found - parameter.choices.begin());
  if (given.value != 0 && given.value != number) {
    return {0, absl::StrCat("'", parameter.name, "' is ", given.value, ", but '", given.choice,
                            "' is its value ", number, ": leave one of them out")};
  }
  return {number};
}

// Every combination of choices as whole vectors, those of the defaults first; numbers are as in
// `defaults`.
std::vector<VectorXd> Combinations(const std::vector<Parameter>& parameters,
                                   const VectorXd& defaults) {
  std::size_t count = 1;
  for (const Parameter& parameter : parameters) {
    if (!parameter.IsChoice()) continue;
    count = std::min(count * parameter.choices.size(), kMaxCombinations + 1);
  }
  std::vector<VectorXd> combinations = {defaults};
  const bool all = count <= kMaxCombinations;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!parameters[p].IsChoice()) continue;
    const auto i = static_cast<Eigen::Index>(p);
    const std::size_t known = all ? combinations.size() : 1;
    for (std::size_t value = 0; value < parameters[p].choices.size(); ++value) {
      if (static_cast<double>(value) == defaults(i)) continue;
      for (std::size_t k = 0; k < known; ++k) {
        VectorXd q = combinations[k];
        q(i) = static_cast<double>(value);
        combinations.push_back(std::move(q));
      }
    }
  }
  return combinations;
}

// Every corner of the box of the numbers, or the ends of single ones where there are many; choices
// are as in `middle`.
std::vector<VectorXd> Corners(const std::vector<Parameter>& parameters, const VectorXd& middle) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!parameters[i].IsChoice()) numbers.push_back(i);
  }
  std::vector<VectorXd> corners;
  if (numbers.empty()) return corners;
  if (numbers.size() <= kMaxCornerParameters) {
    for (unsigned corner = 0; corner < (1U << numbers.size()); ++corner) {
      VectorXd& q = corners.emplace_back(middle);
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        const Parameter& parameter = parameters[numbers[k]];
        q(static_cast<Eigen::Index>(numbers[k])) =
            (corner >> k) & 1U ? parameter.maximum : parameter.minimum;
      }
    }
    return corners;
  }
  for (const std::size_t i : numbers) {
    for (const double end : {parameters[i].minimum, parameters[i].maximum}) {
      corners.emplace_back(middle)(static_cast<Eigen::Index>(i)) = end;
    }
  }
  return corners;
}

// Gives `q` the choices of a combination.
VectorXd WithChoices(const std::vector<Parameter>& parameters, VectorXd q,
                     const VectorXd& combination) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (parameters[i].IsChoice()) q(at) = combination(at);
  }
  return q;
}

}  // namespace

void FillChoice(Parameter& parameter) {
  if (!parameter.IsChoice()) return;
  if (parameter.unit.empty()) parameter.unit = "1";
  if (parameter.maximum == 0) parameter.maximum = static_cast<double>(parameter.choices.size()) - 1;
  if (parameter.step == 0) parameter.step = 1;
}

std::vector<ExpressionName> ExpressionNames(const std::vector<Parameter>& parameters) {
  std::vector<ExpressionName> names;
  for (const Parameter& parameter : parameters) {
    const auto unit = ParseUnit(parameter.unit);
    names.push_back({parameter.name, unit.ok() ? std::optional(unit->dimension) : std::nullopt,
                     parameter.choices});
  }
  return names;
}

bool IsWhole(const Parameter& parameter) {
  return parameter.IsChoice() ||
         (parameter.step == 1 && parameter.minimum == std::round(parameter.minimum));
}

VectorXd WithWholeNumbers(const std::vector<Parameter>& parameters, VectorXd q) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    double& value = q(static_cast<Eigen::Index>(i));
    if (IsWhole(parameters[i])) value = std::round(value);
  }
  return q;
}

const std::string& ChoiceAt(const Parameter& parameter, double value) {
  static const std::string none;
  if (!parameter.IsChoice() || FaultOf(parameter, value)) return none;
  return parameter.choices[static_cast<std::size_t>(value)];
}

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
      faults.push_back(
          {field + ".name", absl::StrCat("there is no parameter '", given.name, "'",
                                         NamesOffered(given.name, parameters, &Parameter::name))});
    } else if (!seen.insert(given.name).second) {
      faults.push_back({field + ".name", absl::StrCat("'", given.name, "' is given twice")});
    } else if (const GivenValue read = ReadValue(*found, given); read.fault) {
      faults.push_back({field + (given.choice.empty() ? ".value" : ".choice"), *read.fault});
    } else {
      q(found - parameters.begin()) = read.value;
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
    if (parameters[i].IsChoice()) {
      const auto fault = FaultOf(parameters[i], value);
      if (fault) findings.push_back({absl::StrCat("parameters[", i, "]"), *fault});
      continue;
    }
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
  const VectorXd middle = Defaults(parameters);
  const std::vector<VectorXd> combinations = Combinations(parameters, middle);
  std::vector<VectorXd> points = combinations;
  const std::vector<VectorXd> corners = Corners(parameters, middle);
  const bool with_all = corners.size() * combinations.size() <= kMaxCombinations;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    for (std::size_t k = 0; k < (with_all ? combinations.size() : 1); ++k) {
      points.push_back(
          WithChoices(parameters, corners[c], combinations[(c + k) % combinations.size()]));
    }
  }
  // The engine is exactly specified by the standard; its distributions are not.
  std::mt19937_64 bits(1);
  for (int k = 0; k < random; ++k) {
    VectorXd q(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Parameter& parameter = parameters[static_cast<std::size_t>(i)];
      const double unit = static_cast<double>(bits() >> 11) * 0x1p-53;
      q(i) = parameter.minimum + unit * (parameter.maximum - parameter.minimum);
      if (IsWhole(parameter)) q(i) = std::round(q(i));
    }
    points.push_back(WithChoices(parameters, q,
                                 combinations[static_cast<std::size_t>(k) % combinations.size()]));
  }
  return points;
}

std::string ToText(const std::vector<Parameter>& parameters, const Eigen::Ref<const VectorXd>& q) {
  std::string text;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double value = q(static_cast<Eigen::Index>(i));
    const std::string& choice = ChoiceAt(parameters[i], value);
    absl::StrAppend(&text, i == 0 ? "" : ", ", parameters[i].name, " = ");
    if (choice.empty()) {
      absl::StrAppend(&text, value);
    } else {
      absl::StrAppend(&text, choice);
    }
  }
  return text;
}

std::vector<StructureChoice> ChosenAt(const std::vector<Parameter>& parameters, const VectorXd& q) {
  std::vector<StructureChoice> chosen;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!parameters[i].IsChoice()) continue;
    chosen.push_back(
        {parameters[i].name, ChoiceAt(parameters[i], q(static_cast<Eigen::Index>(i)))});
  }
  return chosen;
}

std::vector<NamedValue> NamedValues(const std::vector<Parameter>& parameters, const VectorXd& q) {
  std::vector<NamedValue> values;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double value = q(static_cast<Eigen::Index>(i));
    values.push_back({parameters[i].name, value, ChoiceAt(parameters[i], value)});
  }
  return values;
}

}  // namespace mortise::parametric
