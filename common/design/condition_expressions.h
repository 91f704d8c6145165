// The boundary conditions that parts and assemblies write, with their expressions parsed once.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/design/template_validation.h"
#include "common/expressions/expression.h"

namespace mortise::parametric {

// Can be evaluated from any number of threads.
class ConditionExpressions {
 public:
  // Holds no conditions.
  ConditionExpressions() = default;

  // Parses the expressions; what is wrong, with its place ("boundary_conditions[2].components[0]",
  // "boundary_conditions[2].present", "reference_temperature"), is added to `findings`, and then
  // nothing else may be called. Names are not looked at, nor whether parts and faces exist, but
  // what acts on the whole body has neither.
  ConditionExpressions(std::vector<BoundaryCondition> conditions,
                       const std::string& reference_temperature,
                       const std::vector<ExpressionName>& parameters,
                       std::vector<FieldViolation>& findings);

  std::size_t size() const { return conditions_.size(); }

  // Returns the name of the condition of this index.
  const std::string& NameOf(std::size_t index) const { return conditions_[index].definition.name; }

  // Returns whether the condition of this index acts at `q`. INVALID_ARGUMENT naming "present".
  absl::StatusOr<bool> IsPresent(std::size_t index, const Eigen::VectorXd& q) const;

  // Returns the condition of this index at `q`, whether it acts there or not. INVALID_ARGUMENT
  // naming the component that cannot be computed or is not what it must be, and the condition.
  absl::StatusOr<EvaluatedBoundaryCondition> At(std::size_t index, const Eigen::VectorXd& q) const;

  // Returns the reference temperature, K; nothing where there is none. INVALID_ARGUMENT naming
  // "reference_temperature".
  absl::StatusOr<std::optional<double>> ReferenceTemperature(const Eigen::VectorXd& q) const;

 private:
  struct Condition {
    BoundaryCondition definition;
    std::optional<Expression> present;                  // nothing where it always is
    std::vector<std::optional<Expression>> components;  // nothing where a displacement is free
  };

  std::vector<Condition> conditions_;
  std::optional<Expression> reference_temperature_;
};

}  // namespace mortise::parametric
