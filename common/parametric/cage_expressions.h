// The expressions of a cage template: parsed once, evaluated with or without derivatives. Private
// to the cage_* files.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/parametric/cage_template.h"
#include "common/parametric/expression.h"
#include "common/parametric/template_validation.h"

namespace mortise::parametric {

// Numbers of a template at one point, and optionally their derivatives.
struct CageNumbers {
  Eigen::Matrix3Xd cage;    // 3 × C, m, the cage's vertices
  Eigen::MatrixXd by_cage;  // 3C × n: row 3c + axis is the gradient; empty if not asked for
};

// A condition's numbers at one point; those that its kind does not have are 0.
struct CageConditionNumbers {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N
  double amount = 0;                                // Pa, W/m² or K
};

// Can be evaluated from any number of threads.
class CageExpressions {
 public:
  // Parses; what is wrong, with its place, is added to `findings`, and then nothing else may be
  // called.
  CageExpressions(const CageTemplate& definition, std::vector<Finding>& findings);

  // Where the cage's vertices are at `q`, one entry a parameter, which need not be in range.
  // INVALID_ARGUMENT naming the field of every expression that cannot be evaluated, or of a point
  // farther than 1 km from the origin.
  absl::StatusOr<CageNumbers> Cage(const Eigen::VectorXd& q, bool with_gradient) const;

  // The numbers of the conditions, in their order. INVALID_ARGUMENT as above; temperatures must be
  // greater than 0.
  absl::StatusOr<std::vector<CageConditionNumbers>> Conditions(const Eigen::VectorXd& q) const;

 private:
  struct Placed {
    std::string field;                     // "cage.vertices[3].x"
    std::optional<Expression> expression;  // none where the text is empty: 0
  };
  struct Condition {
    BoundaryConditionKind kind;
    std::array<Placed, 3> force;
    Placed amount;
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
};

}  // namespace mortise::parametric
