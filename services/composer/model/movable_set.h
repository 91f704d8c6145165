// The feasible set of a component that moves freely in space, with nearness as people mean it: that
// it is moved as a whole counts little beside that its parts are moved against each other.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "common/assembly/relations/feasible_set.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// Immutable.
class MovableSet {
 public:
  // Changes are measured as ChangeScales says, places by the component's diagonal; a move of the
  // whole counts as that of one part. O(degrees of freedom² · parameters).
  explicit MovableSet(const parametric::ParametricAssembly& assembly);

  // The set in parameters in space.
  const parametric::FeasibleSet& feasible() const { return feasible_; }

  struct Nearest {
    Eigen::VectorXd q;  // in space
    double cost = 0;    // the squared distance from the wish
  };

  // Returns the member that meets the demands and is nearest to `wish`, a member itself: the
  // minimum over q and a move s of ‖q − wish − s‖² + ‖s‖². Nothing if none meets them. INTERNAL as
  // ProjectOnto.
  absl::StatusOr<std::optional<Nearest>> NearestTo(
      const Eigen::VectorXd& wish, const std::vector<parametric::Demand>& demands) const;

 private:
  Eigen::RowVectorXd RowOf(const parametric::LinearForm& form) const;

  parametric::FeasibleSet feasible_;
  Eigen::VectorXd weights_;       // of squares of changes
  Eigen::MatrixXd moves_;         // |q| × 3, each one unit of distance
  Eigen::MatrixXd inequalities_;  // in the coordinates of the basis and of the moves
};

}  // namespace mortise::composer
