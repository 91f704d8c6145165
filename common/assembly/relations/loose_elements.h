// What can move or grow without end, because nothing that it touches, and no item, holds it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/relations/feasible_set.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// FAILED_PRECONDITION, FEASIBLE_SET_UNBOUNDED, naming the first ten elements that the feasible set
// lets move or grow without end, with their axes; OK if there is none, decided exactly. What
// `explain` says of all such elements, by index, is told after that.
absl::Status CheckBounded(
    const Assembly& assembly, const std::vector<Element>& elements, const FeasibleSet& feasible_set,
    const std::function<std::string(const std::vector<int>& loose)>& explain =
        [](const std::vector<int>&) { return std::string(); });

// Returns what ends a change of q that can be followed without end (FeasibleSet's
// UnboundedDirection): of what it moves, that which lies nearest to something that it does not move
// keeps its distance from that along an axis, as drawn. Principal elements come before connecting
// ones, and the centres of joints last. `direction` must not move everything alike. Our own: it
// holds pieces of a design as they lie, once the parts are gone that held them. O(elements²).
Relationship HoldWhatMoves(const Assembly& assembly, const std::vector<Element>& elements,
                           const Eigen::VectorXd& direction);

}  // namespace mortise::parametric
