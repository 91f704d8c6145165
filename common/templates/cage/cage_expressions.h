// The expressions of a cage template: parsed once, evaluated with or without derivatives. Private
// to the cage_* files.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/template_validation.h"
#include "common/expressions/expression.h"
#include "common/templates/cage/cage_template.h"

namespace mortise::parametric {

// Numbers of a template at one point, and optionally their derivatives.
struct CageNumbers {
  Eigen::Matrix3Xd cage;    // 3 × C, m, the cage's vertices
  Eigen::MatrixXd by_cage;  // 3C × n: row 3c + axis is the gradient; empty if not asked for
};

// Can be evaluated from any number of threads.
class CageExpressions {
 public:
  // Parses the expressions; what is wrong, with its place, is added to `findings`, and then nothing
  // else may be called.
  CageExpressions(const CageTemplate& definition, std::vector<FieldViolation>& findings);

  // Returns where the cage's vertices are at `q`, one entry a parameter, which need not be in
  // range. INVALID_ARGUMENT naming the field of every expression that cannot be evaluated, or of a
  // point farther than 1 km from the origin.
  absl::StatusOr<CageNumbers> Cage(const Eigen::VectorXd& q, bool with_gradient) const;

  // The conditions at `q`.
  struct Conditions {
    std::vector<std::optional<ConditionNumbers>> numbers;  // in their order; none of what is absent
    std::optional<double> reference_temperature;           // K
  };

  // Returns the conditions that act at `q`. INVALID_ARGUMENT naming the field and the condition of
  // every expression that cannot be evaluated or is not what it must be: temperatures and
  // coefficients are greater than 0.
  absl::StatusOr<Conditions> ConditionsAt(const Eigen::VectorXd& q) const;

 private:
  struct Placed {
    std::string field;                     // "cage.vertices[3].x"
    std::optional<Expression> expression;  // none where the text is empty: 0
  };
  struct Condition {
    std::string name;
    BoundaryConditionKind kind;
    std::vector<Placed> components;
    Placed present = {};  // no expression where it always acts
  };
  // Parameters, then definitions.
  struct Names {
    Eigen::VectorXd values;
    Eigen::MatrixXd gradients;  // a row for each name; empty if not asked for
  };

  absl::StatusOr<Names> NamesAt(const Eigen::VectorXd& q, bool with_gradient) const;

  std::vector<Placed> definitions_;
  std::vector<std::array<Placed, 3>> cage_;
  std::vector<Condition> conditions_;
  std::optional<Expression> reference_temperature_;
};

}  // namespace mortise::parametric
