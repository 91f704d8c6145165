// Finds which planes a component is aligned with: of all combinations of one plane for each
// constraint the one whose design is nearest to the present one, (5.2) of the thesis.
#pragma once

#include <Eigen/Core>
#include <functional>
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
  // What it is worth that it has one, as the set measures squared distances: where that costs more,
  // the form has none. Of those that are worth an infinite cost as few as possible have none.
  // Without it, it has one in any case.
  std::optional<double> worth = std::nullopt;
};

// Stands for a choice that has none of its values.
inline constexpr int kNoPlane = -1;

struct ChosenPlanes {
  Eigen::VectorXd q;  // feasible, and nearest of all
  // Its squared distance, as the set measures it, and what those choices are worth that have none
  // of their values; of an infinite worth only how many: `given_up`.
  double cost = 0;
  int given_up = 0;
  std::vector<int> values;  // of each choice, the index of the value that it has; or kNoPlane
  int solved = 0;           // quadratic programmes
};

// Whether a combination, as ChosenPlanes::values says it, may be taken.
using IsAdmissible = std::function<absl::StatusOr<bool>(const std::vector<int>& values)>;

// Returns the combination of values whose nearest design to `wish`, in space, is the nearest of
// all that are admissible (all, without `is_admissible`); nothing if there is none. Of those that
// cost the same (to a millionth), the first in the order of the values. Exact, by branch and bound:
// constraints only add to the cost, so that whatever begins with a combination that costs more than
// a known one need not be looked at; what is not admissible is left out, and bounds nothing. Fails
// as MovableSet::NearestTo and `is_admissible`.
absl::StatusOr<std::optional<ChosenPlanes>> ChoosePlanes(const MovableSet& set,
                                                         const Eigen::VectorXd& wish,
                                                         const std::vector<ChoiceOfPlanes>& choices,
                                                         const IsAdmissible& is_admissible = {});

// The same by looking at all combinations.
absl::StatusOr<std::optional<ChosenPlanes>> EnumeratePlanes(
    const MovableSet& set, const Eigen::VectorXd& wish, const std::vector<ChoiceOfPlanes>& choices,
    const IsAdmissible& is_admissible = {});

}  // namespace mortise::composer
