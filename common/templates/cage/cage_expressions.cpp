#include "common/templates/cage/cage_expressions.h"

#include <cmath>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"

namespace mortise::parametric {
namespace {

constexpr double kFarthest = 1e3;  // m, from the origin

// Parses the expressions of a template.
class Parser {
 public:
  Parser(std::vector<ExpressionName>& names, std::vector<FieldViolation>& findings)
      : names_(names), findings_(findings) {}

  std::optional<Expression> Parse(const std::string& field, const std::string& text,
                                  bool may_be_empty) {
    if (text.empty() && may_be_empty) return std::nullopt;
    return Take(field, text, Expression::Parse(text, names_));
  }

  std::optional<Expression> ParseCondition(const std::string& field, const std::string& text) {
    if (text.empty()) return std::nullopt;
    return Take(field, text, Expression::ParseCondition(text, names_));
  }

 private:
  std::optional<Expression> Take(const std::string& field, const std::string& text,
                                 absl::StatusOr<Expression> expression) {
    if (expression.ok()) return *std::move(expression);
    findings_.push_back(
        {field, absl::StrCat("'", text.substr(0, 80), "': ", expression.status().message())});
    return std::nullopt;
  }

  std::vector<ExpressionName>& names_;
  std::vector<FieldViolation>& findings_;
};

FieldViolation Fault(const std::string& field, const absl::Status& status) {
  return {field, std::string(status.message())};
}

}  // namespace

CageExpressions::CageExpressions(const CageTemplate& definition,
                                 std::vector<FieldViolation>& findings) {
  std::vector<ExpressionName> names = ExpressionNames(definition.parameters);
  Parser parser(names, findings);
  for (std::size_t i = 0; i < definition.definitions.size(); ++i) {
    const std::string field = absl::StrCat("definitions[", i, "].value");
    definitions_.push_back({field, parser.Parse(field, definition.definitions[i].value, false)});
    // Also where it cannot be read, lest everything that uses it be reported too.
    names.push_back({definition.definitions[i].name});
  }
  const auto point = [&parser](const std::string& field, const CagePoint& texts) {
    std::array<Placed, 3> placed = {Placed{field + ".x", {}}, Placed{field + ".y", {}},
                                    Placed{field + ".z", {}}};
    placed[0].expression = parser.Parse(placed[0].field, texts.x, true);
    placed[1].expression = parser.Parse(placed[1].field, texts.y, true);
    placed[2].expression = parser.Parse(placed[2].field, texts.z, true);
    return placed;
  };
  for (std::size_t i = 0; i < definition.cage.vertices.size(); ++i) {
    cage_.push_back(point(absl::StrCat("cage.vertices[", i, "]"), definition.cage.vertices[i]));
  }
  for (std::size_t i = 0; i < definition.conditions.size(); ++i) {
    const CageCondition& condition = definition.conditions[i];
    const std::string field = absl::StrCat("conditions[", i, "]");
    Condition parsed{condition.name, condition.kind, {}};
    parsed.present = {field + ".present",
                      parser.ParseCondition(field + ".present", condition.present)};
    const std::span<const ConditionComponent> components = ComponentsOf(condition.kind);
    for (std::size_t k = 0; k < components.size(); ++k) {
      const std::string place = absl::StrCat(field, ".", components[k].field);
      parsed.components.push_back(
          {place, parser.Parse(place, condition.components[k], components[k].coordinate)});
    }
    conditions_.push_back(std::move(parsed));
  }
  reference_temperature_ =
      parser.Parse("reference_temperature", definition.reference_temperature, true);
}

absl::StatusOr<CageExpressions::Names> CageExpressions::NamesAt(const Eigen::VectorXd& q,
                                                                bool with_gradient) const {
  const Eigen::Index count = q.size() + static_cast<Eigen::Index>(definitions_.size());
  Names names{Eigen::VectorXd::Zero(count), {}};
  names.values.head(q.size()) = q;
  if (with_gradient) {
    names.gradients = Eigen::MatrixXd::Zero(count, q.size());
    names.gradients.topRows(q.size()).setIdentity();
  }
  for (Eigen::Index i = q.size(); i < count; ++i) {
    const Placed& placed = definitions_[static_cast<std::size_t>(i - q.size())];
    if (with_gradient) {
      const auto dual = placed.expression->ValueAndGradient(names.values.head(i));
      if (!dual.ok()) return ToStatus({Fault(placed.field, dual.status())});
      names.values(i) = dual->value;
      names.gradients.row(i) = dual->gradient.transpose() * names.gradients.topRows(i);
    } else {
      const auto value = placed.expression->Value(names.values.head(i));
      if (!value.ok()) return ToStatus({Fault(placed.field, value.status())});
      names.values(i) = *value;
    }
  }
  return names;
}

absl::StatusOr<CageNumbers> CageExpressions::Cage(const Eigen::VectorXd& q,
                                                  bool with_gradient) const {
  MORTISE_ASSIGN_OR_RETURN(const Names names, NamesAt(q, with_gradient));
  std::vector<FieldViolation> findings;
  const auto count = static_cast<Eigen::Index>(cage_.size());
  CageNumbers numbers{Eigen::Matrix3Xd::Zero(3, count), {}};
  if (with_gradient) numbers.by_cage = Eigen::MatrixXd::Zero(3 * count, q.size());
  for (Eigen::Index c = 0; c < count; ++c) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const Placed& placed = cage_[static_cast<std::size_t>(c)][static_cast<std::size_t>(axis)];
      if (!placed.expression) continue;
      absl::StatusOr<double> value = 0.0;
      if (with_gradient) {
        const auto dual = placed.expression->ValueAndGradient(names.values);
        if (dual.ok()) {
          value = dual->value;
          numbers.by_cage.row(3 * c + axis) = dual->gradient.transpose() * names.gradients;
        } else {
          value = dual.status();
        }
      } else {
        value = placed.expression->Value(names.values);
      }
      if (!value.ok()) {
        findings.push_back(Fault(placed.field, value.status()));
      } else if (std::abs(*value) > kFarthest) {
        findings.push_back({placed.field, absl::StrCat("'", placed.expression->text(), "' is ",
                                                       *value, " m, farther than 1 km")});
      } else {
        numbers.cage(axis, c) = *value;
      }
    }
  }
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  return numbers;
}

absl::StatusOr<CageExpressions::Conditions> CageExpressions::ConditionsAt(
    const Eigen::VectorXd& q) const {
  MORTISE_ASSIGN_OR_RETURN(const Names names, NamesAt(q, false));
  std::vector<FieldViolation> findings;
  Conditions at;
  for (const Condition& condition : conditions_) {
    if (condition.present.expression) {
      const auto present = condition.present.expression->Holds(names.values);
      if (!present.ok()) {
        findings.push_back({condition.present.field,
                            absl::StrCat("'", condition.name, "': ", present.status().message())});
      }
      if (!present.value_or(false)) {
        at.numbers.emplace_back();
        continue;
      }
    }
    const std::span<const ConditionComponent> components = ComponentsOf(condition.kind);
    std::vector<std::optional<double>> values;
    for (std::size_t k = 0; k < components.size(); ++k) {
      std::optional<double>& component = values.emplace_back();
      const Placed& placed = condition.components[k];
      if (!placed.expression) continue;
      const auto value = placed.expression->Value(names.values);
      const std::string fault =
          value.ok() ? FaultOf(components[k], *value) : std::string(value.status().message());
      if (!fault.empty()) {
        findings.push_back({placed.field, absl::StrCat("'", condition.name, "': ", fault)});
      }
      component = value.value_or(0);
    }
    at.numbers.push_back(NumbersOf(condition.kind, values));
  }
  if (reference_temperature_) {
    const auto value = reference_temperature_->Value(names.values);
    const std::string fault =
        value.ok() ? FaultOfTemperature(*value) : std::string(value.status().message());
    if (!fault.empty()) findings.push_back({"reference_temperature", fault});
    at.reference_temperature = value.value_or(0);
  }
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  return at;
}

}  // namespace mortise::parametric
