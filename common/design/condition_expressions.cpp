#include "common/design/condition_expressions.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

std::string Place(std::size_t index) { return absl::StrCat("boundary_conditions[", index, "]"); }

std::string Place(std::size_t index, std::size_t component) {
  return absl::StrCat(Place(index), ".components[", component, "]");
}

std::optional<Expression> Take(const std::string& field, const std::string& text,
                               absl::StatusOr<Expression> expression,
                               std::vector<FieldViolation>& findings) {
  if (expression.ok()) return *std::move(expression);
  findings.push_back(
      {field, absl::StrCat("'", text.substr(0, 80), "': ", expression.status().message())});
  return std::nullopt;
}

void CheckWholeBody(const std::string& field, const BoundaryCondition& condition,
                    std::vector<FieldViolation>& findings) {
  if (ActsOnFace(condition.kind)) return;
  constexpr char kWhole[] = "must be left out: this kind acts on the whole body";
  if (!condition.part.empty()) findings.push_back({field + ".part", kWhole});
  if (!condition.face.empty()) findings.push_back({field + ".face", kWhole});
}

}  // namespace

ConditionExpressions::ConditionExpressions(std::vector<BoundaryCondition> conditions,
                                           const std::string& reference_temperature,
                                           const std::vector<ExpressionName>& parameters,
                                           std::vector<FieldViolation>& findings) {
  std::vector<ConditionUse> uses;
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    const std::string field = Place(i);
    Condition& parsed = conditions_.emplace_back();
    parsed.definition = std::move(conditions[i]);
    const BoundaryCondition& condition = parsed.definition;
    CheckWholeBody(field, condition, findings);
    CheckCondition(field, condition.kind, condition.components, condition.load_case, findings);
    uses.push_back({condition.kind, condition.load_case});
    if (!condition.present.empty()) {
      parsed.present = Take(field + ".present", condition.present,
                            Expression::ParseCondition(condition.present, parameters), findings);
    }
    const std::size_t expected = ComponentsOf(condition.kind).size();
    if (condition.components.size() != expected) {
      findings.push_back({field + ".components", absl::StrCat("has ", condition.components.size(),
                                                              " expressions, not ", expected)});
      continue;
    }
    for (std::size_t k = 0; k < expected; ++k) {
      const std::string& text = condition.components[k];
      const bool is_free = condition.kind == BoundaryConditionKind::kDisplacement && text.empty();
      parsed.components.push_back(
          is_free ? std::nullopt
                  : Take(Place(i, k), text, Expression::Parse(text, parameters), findings));
    }
  }
  if (!reference_temperature.empty()) {
    reference_temperature_ = Take("reference_temperature", reference_temperature,
                                  Expression::Parse(reference_temperature, parameters), findings);
  }
  CheckConditionsTogether("boundary_conditions", uses, reference_temperature, findings);
}

absl::StatusOr<bool> ConditionExpressions::IsPresent(std::size_t index,
                                                     const Eigen::VectorXd& q) const {
  const std::optional<Expression>& present = conditions_[index].present;
  if (!present) return true;
  const absl::StatusOr<bool> holds = present->Holds(q);
  if (holds.ok()) return *holds;
  return InvalidField(
      Place(index) + ".present",
      absl::StrCat("'", conditions_[index].definition.name, "': ", holds.status().message()));
}

absl::StatusOr<EvaluatedBoundaryCondition> ConditionExpressions::At(
    std::size_t index, const Eigen::VectorXd& q) const {
  const BoundaryCondition& definition = conditions_[index].definition;
  const auto& components = conditions_[index].components;
  std::vector<std::optional<double>> values(components.size());
  for (std::size_t k = 0; k < components.size(); ++k) {
    if (!components[k]) continue;
    const absl::StatusOr<double> value = components[k]->Value(q);
    const std::string fault = value.ok() ? FaultOf(ComponentsOf(definition.kind)[k], *value)
                                         : std::string(value.status().message());
    if (!fault.empty()) {
      return InvalidField(Place(index, k), absl::StrCat("'", definition.name, "': ", fault));
    }
    values[k] = *value;
  }
  EvaluatedBoundaryCondition condition;
  static_cast<ConditionNumbers&>(condition) = NumbersOf(definition.kind, values);
  condition.name = definition.name;
  condition.kind = definition.kind;
  condition.part = definition.part;
  condition.face = definition.face;
  condition.load_case = definition.load_case;
  return condition;
}

absl::StatusOr<std::optional<double>> ConditionExpressions::ReferenceTemperature(
    const Eigen::VectorXd& q) const {
  if (!reference_temperature_) return std::nullopt;
  const absl::StatusOr<double> value = reference_temperature_->Value(q);
  const std::string fault =
      value.ok() ? FaultOfTemperature(*value) : std::string(value.status().message());
  if (!fault.empty()) return InvalidField("reference_temperature", fault);
  return *value;
}

}  // namespace mortise::parametric
