// Finds which planes a component is aligned with: of all combinations of one plane for each
// constraint the one whose design is nearest to the present one, (5.2) of the thesis.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/polyhedra/linear_form.h"
#include "services/composer/model/movable_set.h"

namespace mortise::composer {

// A form that is to have one of these values, m.
struct ChoiceOfPlanes {
  parametric::LinearForm form;
  std::vector<double> values;
};

struct ChosenPlanes {
  Eigen::VectorXd q;        // feasible, and nearest of all
  double cost = 0;          // its squared distance, as the set measures it
  std::vector<int> values;  // of each choice, the index of the value that it has
  int solved = 0;           // quadratic programmes
};

// Returns the combination of values whose nearest design to `wish`, in space, is the nearest of
// all; nothing if no combination is feasible. Of those that cost the same (to a millionth), the
// first in the order of the values. Exact, by branch and bound: constraints only add to the cost,
// so that whatever begins with a combination that costs more than a known one need not be looked
// at. Fails as MovableSet::NearestTo.
absl::StatusOr<std::optional<ChosenPlanes>> ChoosePlanes(
    const MovableSet& set, const Eigen::VectorXd& wish, const std::vector<ChoiceOfPlanes>& choices);

// The same by looking at all combinations.
absl::StatusOr<std::optional<ChosenPlanes>> EnumeratePlanes(
    const MovableSet& set, const Eigen::VectorXd& wish, const std::vector<ChoiceOfPlanes>& choices);

}  // namespace mortise::composer
